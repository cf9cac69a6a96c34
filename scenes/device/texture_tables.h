// The tables of a scene's textures.
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
  std::vector<MeshAttribute> attributes;  ///< that textures show, in the order of a triangle's colours
  std::vector<int> places;                ///< of the scene's textures in the table, or kNoTexture
};

/// Of those that the materials have, those among `others`, and those that they hold: the rest is left out,
/// with its bitmaps.
/// Indices of materials become those of the table.
TextureTables texture_tables(const SceneDescription& scene, std::span<Material> materials,
                             std::span<const int> others);

}  // namespace penumbra
