// Bitmaps of textures: texels as their file has them.
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

/// Of 8 and 16 bit, values are whole numbers that count 0 to 1, by an encoding (sRGB, say) or linearly;
/// others are what they say, finite.
struct Bitmap {
  std::string name;  ///< the file, or for messages what it is
  int width = 0, height = 0;
  int channels = 0;  ///< 1: grey, 3: red, green and blue
  TexelType type = TexelType::kByte;
  /// Rows from the top, channels of a texel side by side, in words whose lowest byte is first, as of texel.h.
  std::vector<std::uint32_t> words;
  std::shared_ptr<const std::string> contents =
      {};  ///< of one that is no file of its own: what a file of it has
};

}  // namespace penumbra
