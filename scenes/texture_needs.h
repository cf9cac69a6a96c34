// What the textures of a shape's materials and of its emission require from the shape.
#pragma once

#include <vector>

#include "scenes/scene_description.h"

namespace penumbra {

struct TextureNeeds {
  bool coordinates = false;  ///< texture coordinates
  std::vector<int> mapped;   ///< indices of the textures that use texture coordinates
  std::vector<MeshAttribute> attributes;
};
TextureNeeds texture_needs(const SceneDescription& scene, const Shape& shape);

/// What the shape lacks: texture coordinates, if it is a mesh without any (barycentric coordinates are used
/// instead), and attributes.
TextureNeeds missing_for_textures(const SceneDescription& scene, const Shape& shape);

}  // namespace penumbra
