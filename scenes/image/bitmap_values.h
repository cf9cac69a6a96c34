// Decodes the values of a bitmap.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/gtc/packing.hpp>
#include <vector>

#include "scenes/image/bitmap.h"

namespace penumbra {

constexpr float kSrgb = -1.0f;  ///< special value of a gamma: decode sRGB

/// Decodes the integer n of 0 ... most: (n / most)^gamma, or by the sRGB curve (IEC 61966-2-1) with kSrgb.
inline float decoded_value(int n, int most, float gamma) {
  const double x = double(n) / most;
  if (gamma != kSrgb) return float(gamma == 1.0f ? x : std::pow(x, double(gamma)));
  return float(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

/// Value number k of a bitmap. Integers are decoded with `gamma`.
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

/// All values of a bitmap as bitmap_value decodes them. It uses a table for 8 and 16 bits, so it is faster if
/// every value of an image is needed.
class BitmapValues {
 public:
  BitmapValues(const Bitmap& bitmap, float gamma) : words_(bitmap.words.data()), type_(bitmap.type) {
    if (type_ == TexelType::kFloat) return;
    const std::size_t numbers = type_ == TexelType::kByte ? 256 : 65536;
    Bitmap all{"", int(numbers), 1, 1, type_, std::vector<std::uint32_t>(numbers)};
    for (std::size_t n = 0; n < numbers; ++n) {
      all.words[0] = std::uint32_t(n);
      table_.push_back(float(bitmap_value(all, 0, gamma)));
    }
  }

  float operator[](std::size_t k) const {
    if (type_ == TexelType::kByte) return table_[words_[k / 4] >> (k % 4 * 8) & 0xffu];
    if (type_ != TexelType::kFloat) return table_[words_[k / 2] >> (k % 2 * 16) & 0xffffu];
    return std::bit_cast<float>(words_[k]);
  }

 private:
  const std::uint32_t* words_;
  TexelType type_;
  std::vector<float> table_;
};

/// A bitmap of floats with these values; rows from the top.
template <typename Values>
Bitmap float_bitmap(std::string name, int width, int height, int channels, const Values& values) {
  Bitmap bitmap{std::move(name), width, height, channels, TexelType::kFloat, {}};
  bitmap.words.reserve(values.size());
  for (const auto value : values) bitmap.words.push_back(std::bit_cast<std::uint32_t>(float(value)));
  return bitmap;
}

/// The mean of a bitmap's channels, decoded with `gamma`, as linear grey.
inline Bitmap channel_mean(const Bitmap& bitmap, float gamma) {
  const BitmapValues values(bitmap, gamma);
  const auto channels = std::size_t(bitmap.channels);
  std::vector<float> means(std::size_t(bitmap.width) * std::size_t(bitmap.height));
  for (std::size_t i = 0; i < means.size(); ++i) {
    double sum = 0;
    for (std::size_t c = 0; c < channels; ++c) sum += double(values[i * channels + c]);
    means[i] = float(sum / double(channels));
  }
  return float_bitmap(bitmap.name, bitmap.width, bitmap.height, 1, means);
}

}  // namespace penumbra
