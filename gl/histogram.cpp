#include "gl/histogram.h"

#include <algorithm>
#include <cmath>

namespace penumbra {

Histogram histogram_of(std::span<const float> rgb, float gain) {
  Histogram histogram;
  histogram.pixels = rgb.size() / 3;
  constexpr float kBinsPerStop = float(Histogram::kBins) / (Histogram::kHighestStop - Histogram::kLowestStop);
  for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) {
    if (!std::isfinite(rgb[i]) || !std::isfinite(rgb[i + 1]) || !std::isfinite(rgb[i + 2])) {
      ++histogram.not_finite;
      continue;
    }
    const float luminance = gain * (0.2126f * rgb[i] + 0.7152f * rgb[i + 1] + 0.0722f * rgb[i + 2]);
    if (!(luminance > 0)) {
      ++histogram.not_positive;
      continue;
    }
    const float bin = (std::log2(luminance) - Histogram::kLowestStop) * kBinsPerStop;
    ++histogram.counts[std::size_t(std::clamp(bin, 0.0f, float(Histogram::kBins - 1)))];
  }
  return histogram;
}

}  // namespace penumbra
