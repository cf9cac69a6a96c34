// Builds the tables of a scene's textures.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

struct TextureTables {
  std::vector<TextureNode> textures;
  std::vector<std::uint32_t> texels;
  /// Mesh attributes used by textures, in the order of a triangle's colours.
  std::vector<MeshAttribute> attributes;
  std::vector<int> places;  ///< for each texture of the scene its index in the table, or kNoTexture
};

/// Builds tables of the textures that the materials use, of those in `others`, and of the textures nested in
/// them. Other textures and their bitmaps are left out. The materials' texture indices are changed to those
/// of the table.
TextureTables texture_tables(const SceneDescription& scene, std::span<Material> materials,
                             std::span<const int> others);

}  // namespace penumbra
