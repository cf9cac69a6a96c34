#include "scenes/pbrt/active_transform.h"

#include <array>
#include <memory>
#include <utility>

#include "scenes/transform.h"

namespace penumbra::pbrt {

std::optional<Placement> MotionReader::place(const TransformPair& pair, SourceLocation location,
                                             ReaderReport& report) {
  if (!pair.moves()) return Placement{pair.start};
  if (motion.nodes.empty() || !(last_ == pair)) {
    const std::array keys{TransformKey{start_, pair.start}, TransformKey{end_, pair.end}};
    auto parts = keyed_transform(keys);
    if (!parts) {
      report.error(location, "ActiveTransform: " + parts.error().message);
      return std::nullopt;
    }
    motion.nodes.push_back({.keys = std::move(*parts)});
    last_ = pair;
  }
  return Placement{transform_at(*motion.nodes.back().keys, motion.default_time),
                   int(motion.nodes.size()) - 1};
}

void MotionReader::install(SceneDescription& scene) {
  if (motion.shapes.empty() && motion.instances.empty() && !motion.camera) return;
  scene.time = motion.default_time;
  scene.motion = std::make_shared<const SceneMotion>(std::move(motion));
}

}  // namespace penumbra::pbrt
