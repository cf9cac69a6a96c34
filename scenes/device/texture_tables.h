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
};

/// Of those that the materials have and those that they hold: others are left out, with their bitmaps.
/// Indices of materials become those of the table.
TextureTables texture_tables(const SceneDescription& scene, std::span<Material> materials);

}  // namespace penumbra
