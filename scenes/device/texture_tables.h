// Builds the tables of a scene's textures.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/image/bitmap_values.h"
#include "scenes/scene_description.h"
#include "scenes/textures.h"

namespace penumbra {

/// The table of texels: the bitmaps of a scene's textures, and the decoding of their integer values.
class TexelTable {
 public:
  explicit TexelTable(std::span<const std::shared_ptr<const Bitmap>> bitmaps) : bitmaps_(bitmaps) {}

  /// Tells of a texture that will be placed, so that the table never moves as it grows.
  void expect(const BitmapTexture& texture);

  /// Completes the record of a texture: its kind and the position of its texels. A bitmap is stored once,
  /// however many textures use it.
  void place(const BitmapTexture& texture, TextureNode& node);

  /// Returns the table, including the padding word that kernels may read beyond the last texel.
  [[nodiscard]] std::vector<std::uint32_t> take();

 private:
  int place_bitmap(int index);
  int place_decoding(int values, float gamma);

  std::span<const std::shared_ptr<const Bitmap>> bitmaps_;
  std::set<int> expected_;  ///< bitmaps
  std::size_t expected_words_ = 0;
  std::vector<std::uint32_t> words_;
  std::map<int, int> places_;                       ///< keyed by bitmap
  std::map<std::pair<int, float>, int> decodings_;  ///< keyed by number of values and gamma
};

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
