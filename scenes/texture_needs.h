// What the textures of a shape's materials and of its light need of the shape.
#pragma once

#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

struct TextureNeeds {
  bool coordinates = false;  ///< texture coordinates
  std::vector<int> mapped;   ///< the textures that take them, by index
  std::vector<MeshAttribute> attributes;
};
TextureNeeds texture_needs(const SceneDescription& scene, const Shape& shape);

/// What is missing of it: coordinates of a mesh that has none (barycentric ones stand in for them),
/// attributes.
TextureNeeds missing_for_textures(const SceneDescription& scene, const Shape& shape);

}  // namespace penumbra
