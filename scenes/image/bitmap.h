// Bitmaps of textures: texels as stored in the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace penumbra {

enum class TexelType { kByte, kShort, kHalf, kFloat };

constexpr std::size_t size_of(TexelType type) {
  return type == TexelType::kByte ? 1 : type == TexelType::kFloat ? 4 : 2;
}

/// An image. Values of 8 and 16 bits are integers that represent 0 to 1, either sRGB-encoded or linear.
/// Values of other types are used as they are, and are finite.
struct Bitmap {
  std::string name;  ///< the file name, or a description for messages
  int width = 0, height = 0;
  int channels = 0;  ///< 1: grey; 3: red, green and blue
  TexelType type = TexelType::kByte;
  /// Rows from the top, with the channels of a texel adjacent, packed into words with the lowest byte first,
  /// as in bitmap_texture.h.
  std::vector<std::uint32_t> words;
  std::shared_ptr<const std::string> contents =
      {};  ///< of a bitmap that is not a file itself: the properties of its source file
};

}  // namespace penumbra
