// Builds the tables of a scene's textures.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
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

  /// Completes the record of a texture: its kind and the position of its texels. A bitmap is stored once,
  /// however many textures use it.
  void place(const BitmapTexture& texture, TextureNode& node);

  /// Whether a table has these words.
  [[nodiscard]] bool equals(std::span<const std::uint32_t> table) const;
  /// Returns the table, including the padding word that kernels may read beyond the last texel.
  [[nodiscard]] std::vector<std::uint32_t> take() const;

 private:
  using Words = std::span<const std::uint32_t>;
  int place_bitmap(int index);
  int place_decoding(int values, float gamma);
  int append(Words words);
  [[nodiscard]] std::size_t size() const { return parts_.empty() ? 0 : end_ + 1; }

  std::span<const std::shared_ptr<const Bitmap>> bitmaps_;
  std::vector<Words> parts_;
  std::size_t end_ = 0;  ///< of the last part
  std::deque<std::vector<std::uint32_t>> decoded_;
  std::map<int, int> places_;                       ///< keyed by bitmap
  std::map<std::pair<int, float>, int> decodings_;  ///< keyed by number of values and gamma
};

struct TextureTables {
  std::vector<TextureNode> textures;
  std::vector<std::uint32_t> texels;
  bool earlier_texels = false;  ///< the texels are those of another scene; `texels` is empty
  /// Mesh attributes used by textures, in the order of a triangle's colours.
  std::vector<MeshAttribute> attributes;
  std::vector<int> places;  ///< for each texture of the scene its index in the table, or kNoTexture
};

/// Builds tables of the textures that the materials use, of those in `others`, and of the textures nested in
/// them. Other textures and their bitmaps are left out. The materials' texture indices are changed to those
/// of the table. `earlier`: the texels of another scene, which need not be copied if they are the same.
TextureTables texture_tables(const SceneDescription& scene, std::span<Material> materials,
                             std::span<const int> others, std::span<const std::uint32_t> earlier = {});

}  // namespace penumbra
