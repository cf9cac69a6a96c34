#include <fmt/format.h>

#include "scenes/device/device_scene_builder.h"

namespace penumbra {
namespace {

struct Feature {
  std::uint32_t bit;
  const char* description;
};
#define LIST_FEATURE(name, bit, description) {bit, description},
constexpr Feature kFeatures[] = {PENUMBRA_FEATURES(LIST_FEATURE)};

std::string bytes_text(std::size_t bytes) {
  if (bytes < 10'000) return fmt::format("{} B", bytes);
  if (bytes < 10'000'000) return fmt::format("{:.1f} kB", double(bytes) / 1e3);
  return fmt::format("{:.1f} MB", double(bytes) / 1e6);
}

}  // namespace

SceneSummary summarize(const DeviceScene& scene) {
  const SceneHeader& h = scene.header;
  SceneSummary summary;
  const auto needs = [&](const char* what, std::string amount) {
    summary.needs.emplace_back(what, std::move(amount));
  };
  needs("triangles", std::to_string(h.triangle_count));
  needs("spheres and disks", std::to_string(h.quadric_count));
  needs("materials", std::to_string(h.material_count - 1));
  needs("lights", std::to_string(h.light_count));
  needs("intersector", h.intersector == INTERSECTOR_EMBREE ? "embree"
                       : (h.features & FEATURE_BVH) != 0u  ? "portable, bounding volume hierarchy"
                                                           : "portable, every primitive tested");
  needs("device scene", bytes_text(scene.words.size() * 4 + sizeof h));
  if (h.dropped_triangles > 0)
    summary.left_out.emplace_back("triangles without area", std::to_string(h.dropped_triangles));
  for (const Feature& feature : kFeatures) {
    if ((h.features & feature.bit) != 0u)
      summary.needs.emplace_back("feature", feature.description);
    else
      summary.left_out.emplace_back("feature", feature.description);
  }
  return summary;
}

}  // namespace penumbra
