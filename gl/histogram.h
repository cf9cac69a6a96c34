// The histogram of a picture's luminance.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace penumbra {

struct Histogram {
  static constexpr int kBins = 128;
  static constexpr float kLowestStop = -10, kHighestStop = 6;  ///< log2 of luminance at the ends
  std::array<float, kBins> counts{};  ///< darker and brighter pixels are in the end bins
  std::uint64_t pixels = 0;
  std::uint64_t not_positive = 0;  ///< 0 or less, not in the bins
  std::uint64_t not_finite = 0;    ///< a channel is NaN or infinite, not in the bins
  bool operator==(const Histogram&) const = default;
};

/// Of red, green and blue per pixel, linear Rec. 709, times `gain`.
Histogram histogram_of(std::span<const float> rgb, float gain);

}  // namespace penumbra
