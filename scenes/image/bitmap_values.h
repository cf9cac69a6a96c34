// What the values of a bitmap count.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/gtc/packing.hpp>

#include "scenes/image/bitmap.h"

namespace penumbra {

constexpr float kSrgb = -1.0f;  ///< in the place of a gamma

/// What a whole number n of 0 ... most counts: (n / most)^gamma, or by sRGB (IEC 61966-2-1) with kSrgb.
inline float decoded_value(int n, int most, float gamma) {
  const double x = double(n) / most;
  if (gamma != kSrgb) return float(gamma == 1.0f ? x : std::pow(x, double(gamma)));
  return float(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

/// Value k of a bitmap, whole numbers by `gamma`.
inline double bitmap_value(const Bitmap& bitmap, std::size_t k, float gamma) {
  const auto bits = [&](std::size_t per_word) {
    const std::size_t size = 32 / per_word;
    return int(bitmap.words[k / per_word] >> (k % per_word * size) & ((1u << size) - 1u));
  };
  switch (bitmap.type) {
    case TexelType::kByte:
      return double(decoded_value(bits(4), 255, gamma));
    case TexelType::kShort:
      return double(decoded_value(bits(2), 65535, gamma));
    case TexelType::kHalf:
      return double(glm::unpackHalf1x16(glm::uint16(bits(2))));
    case TexelType::kFloat:
      break;
  }
  return double(std::bit_cast<float>(bitmap.words[k]));
}

/// A bitmap of floats with these values, rows from the top.
template <typename Values>
Bitmap float_bitmap(std::string name, int width, int height, int channels, const Values& values) {
  Bitmap bitmap{std::move(name), width, height, channels, TexelType::kFloat, {}};
  bitmap.words.reserve(values.size());
  for (const auto value : values) bitmap.words.push_back(std::bit_cast<std::uint32_t>(float(value)));
  return bitmap;
}

}  // namespace penumbra
