// What the readers of pbrt's directives share: the graphics state that directives change and that shapes and
// lights use, and the look-up of types.
#pragma once

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <initializer_list>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/material_tree.h"
#include "scenes/pbrt/active_transform.h"
#include "scenes/pbrt/parameters.h"
#include "scenes/reader_report.h"

namespace penumbra::pbrt {

/// The value of a texture: a constant, or a texture of the scene, which `value` does not multiply.
struct TextureValue {
  glm::vec3 value{1.0f};
  int texture = kNoTexture;
};

/// The material of shapes before the first Material directive.
constexpr int kDefaultMaterial = -1;

/// The names in a MediumInterface; empty: no medium. Names are resolved after the whole file was read.
struct MediumNames {
  std::string inside, outside;
  SourceLocation location = {};
  /// Whether a surface separates two different media. If not, light stays in its current medium.
  [[nodiscard]] bool are_different() const { return inside != outside; }
};

/// The parameters of an area light.
struct AreaLight {
  glm::vec3 radiance{1.0f};
  int image = kNoTexture;   ///< texture that multiplies the radiance
  double image_mean = 1.0;  ///< mean luminance of that texture
  bool two_sided = false;
  /// The light is scaled so that pi times its area times its radiance equals this, before its own scale. As
  /// each triangle or patch of a mesh is a light of its own in pbrt, each has this power.
  std::optional<double> power = std::nullopt;
  SourceLocation location = {};
};

struct GraphicsState {
  TransformPair ctm;
  ActiveTransforms active;
  bool reverse_orientation = false;
  int material = kDefaultMaterial;  ///< number of MaterialReader
  std::string material_name = "default";
  std::shared_ptr<const AreaLight> area_light;
  MediumNames media;
  std::string colour_space = "srgb";

  /// Whether shapes in both states have the same transform, material and so on.
  [[nodiscard]] bool has_same_surface(const GraphicsState& o) const {
    return ctm == o.ctm && reverse_orientation == o.reverse_orientation && material == o.material &&
           area_light == o.area_light && media.inside == o.media.inside && media.outside == o.media.outside;
  }
  std::map<std::string, Parameters> defaults;  ///< defaults set by "Attribute", by their target
};

/// What the readers share.
struct Context {
  ReaderReport& report;
  const FileAccess& files;
  std::filesystem::path folder;
  SceneDescription& scene;
  MotionReader motion = {};
  double shutter_time = 1.0;  ///< of the camera
  double sensitivity = 1.0;   ///< of the film, by its iso
  glm::dmat3 balance{1.0};    ///< of the film: its white balance, which the lights get
  /// The factor from radiance to pbrt's pixel values.
  [[nodiscard]] double exposure() const { return shutter_time * sensitivity; }
};

/// The row of that `type`. If there is none, null and a message, which ends in `instead` in lenient mode.
/// `also`: names of supported types that have no row.
template <typename Rows>
const auto* find_row(const Rows& rows, const std::string& type, std::string_view what,
                     std::string_view instead, SourceLocation location, ReaderReport& report,
                     std::initializer_list<const char*> also = {}) {
  for (const auto& row : rows)
    if (type == row.type) return &row;
  std::vector<std::string> known;
  for (const auto& row : rows) known.emplace_back(row.type);
  known.insert(known.end(), also.begin(), also.end());
  report.unsupported(location,
                     fmt::format("{} '{}' is not one that Penumbra reads{}", what, type,
                                 known_names(type, known, "It reads")),
                     instead);
  return static_cast<decltype(&*std::begin(rows))>(nullptr);
}

}  // namespace penumbra::pbrt
