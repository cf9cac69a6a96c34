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

/// Of an area light.
struct AreaLight {
  glm::vec3 radiance{1.0f};
  bool two_sided = false;
  std::optional<double> power = std::nullopt;  ///< instead: pi times the area times this are as much
  SourceLocation location = {};
};

struct GraphicsState {
  glm::dmat4 ctm{1.0};
  bool reverse_orientation = false;
  std::shared_ptr<const SurfaceMaterial> material;
  std::string material_name = "default";
  std::shared_ptr<const AreaLight> area_light;
  std::map<std::string, Parameters> defaults;  ///< of "Attribute", by what they are for
};

/// What the readers share.
struct Context {
  ReaderReport& report;
  const FileAccess& files;
  std::filesystem::path folder;
  SceneDescription& scene;
};

}  // namespace penumbra::pbrt
