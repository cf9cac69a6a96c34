#include "scenes/device/texel_table.h"

#include <bit>
#include <climits>
#include <cmath>

namespace penumbra {

void TexelTable::place(const BitmapTexture& texture, TextureNode& node) {
  const Bitmap& bitmap = *bitmaps_[std::size_t(texture.bitmap)];
  node.kind = bitmap.type == TexelType::kByte    ? TEXTURE_BYTE_BITMAP
              : bitmap.type == TexelType::kShort ? TEXTURE_SHORT_BITMAP
              : bitmap.type == TexelType::kHalf  ? TEXTURE_HALF_BITMAP
                                                 : TEXTURE_FLOAT_BITMAP;
  node.width = bitmap.width;
  node.height = bitmap.height;
  node.channels = bitmap.channels;
  node.decoding = -1;
  if (bitmap.type == TexelType::kByte) node.decoding = place_decoding(256, texture.gamma);
  if (bitmap.type == TexelType::kShort && texture.gamma != 1.0f)
    node.decoding = place_decoding(65536, texture.gamma);
  node.texels = place_bitmap(texture.bitmap);
}

int TexelTable::place_bitmap(int index) {
  const auto [place, is_new] = places_.try_emplace(index, int(words_.size()));
  if (is_new) {
    const std::vector<std::uint32_t>& texels = bitmaps_[std::size_t(index)]->words;
    words_.insert(words_.end(), texels.begin(), texels.end());
  }
  return place->second;
}

int TexelTable::place_decoding(int values, float gamma) {
  const auto [place, is_new] = decodings_.try_emplace({values, gamma}, int(words_.size()));
  if (is_new) {
    for (int n = 0; n < values; ++n)
      words_.push_back(std::bit_cast<std::uint32_t>(decoded_value(n, values - 1, gamma)));
  }
  return place->second;
}

std::vector<std::uint32_t> TexelTable::take() {
  if (!words_.empty()) words_.push_back(0);
  return std::move(words_);
}

}  // namespace penumbra
