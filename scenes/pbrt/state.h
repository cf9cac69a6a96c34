// What pbrt's directives change, and what shapes and lights take from it.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "scenes/material_tree.h"
#include "scenes/pbrt/parameters.h"

namespace penumbra::pbrt {

/// A texture's value: the same everywhere, or a texture of the scene's times nothing.
struct TextureValue {
  glm::vec3 value{1.0f};
  int texture = kNoTexture;
};

/// The material of shapes before the first directive Material.
constexpr int kDefaultMaterial = -1;

/// What a MediumInterface says; empty: no medium. Media are known by their names until the whole file is
/// read.
struct MediumNames {
  std::string inside, outside;
  SourceLocation location = {};
  /// Whether a surface parts two media; if not, light stays in the one where it is.
  [[nodiscard]] bool are_two() const { return inside != outside; }
};

/// Of an area light.
struct AreaLight {
  glm::vec3 radiance{1.0f};
  int image = kNoTexture;   ///< by which the radiance is multiplied
  double image_mean = 1.0;  ///< its mean luminance
  bool two_sided = false;
  std::optional<double> power = std::nullopt;  ///< instead: pi times the area times this are as much
  SourceLocation location = {};
};

struct GraphicsState {
  glm::dmat4 ctm{1.0};
  bool reverse_orientation = false;
  int material = kDefaultMaterial;  ///< of MaterialReader
  std::string material_name = "default";
  std::shared_ptr<const AreaLight> area_light;
  MediumNames media;
  std::string colour_space = "srgb";

  /// Whether shapes are in the same place, of the same material, and so on.
  [[nodiscard]] bool has_same_surface(const GraphicsState& o) const {
    return ctm == o.ctm && reverse_orientation == o.reverse_orientation && material == o.material &&
           area_light == o.area_light && media.inside == o.media.inside && media.outside == o.media.outside;
  }
  std::map<std::string, Parameters> defaults;  ///< of "Attribute", by what they are for
};

/// What the readers share.
struct Context {
  ReaderReport& report;
  const FileAccess& files;
  std::filesystem::path folder;
  SceneDescription& scene;
  double exposure = 1.0;  ///< of the film: by what pbrt's image is brighter than the radiance
};

}  // namespace penumbra::pbrt
