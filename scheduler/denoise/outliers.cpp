#include "scheduler/denoise/outliers.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

/// What a half may not exceed, by the other one. A pixel's own variance does not count: its outlier is in it.
Planes limits_by(const Planes& half, const Planes& variance) {
  // A half has twice the variance of the mean of both.
  Planes bounds = half;
  for (std::size_t i = 0; i < bounds.values.size(); ++i)
    bounds.values[i] += std::sqrt(2 * variance.values[i]);
  Planes limits = half;
  const auto raise = [&](std::span<float> of, std::span<const float> by, int dx, int dy) {
    for (int y = std::max(0, -dy); y < std::min(half.height, half.height - dy); ++y) {
      float* to = of.data() + std::ptrdiff_t(y) * half.width;
      const float* from = by.data() + std::ptrdiff_t(y + dy) * half.width + dx;
      for (int x = std::max(0, -dx); x < std::min(half.width, half.width - dx); ++x)
        to[x] = std::max(to[x], from[x]);
    }
  };
  for (int k = 0; k < half.count; ++k)
    for (int dy = -kOutlierRadius; dy <= kOutlierRadius; ++dy)
      for (int dx = -kOutlierRadius; dx <= kOutlierRadius; ++dx)
        if (dx != 0 || dy != 0) raise(limits.plane(k), bounds.plane(k), dx, dy);
  return limits;
}

/// Half of what is taken from `half` is taken from `color`, the mean of both.
void limit(const Planes& limits, Planes& half, Planes& color) {
  for (std::size_t i = 0; i < half.values.size(); ++i) {
    const float excess = std::max(half.values[i] - limits.values[i], 0.0f);
    half.values[i] -= excess;
    color.values[i] -= excess / 2;
  }
}

}  // namespace

DenoiseInput without_outliers(DenoiseInput noisy) {
  constexpr int kSide = 2 * kOutlierRadius + 1;
  if (!noisy.has_halves() || noisy.color.width < kSide || noisy.color.height < kSide) return noisy;
  // Both from what is noisy.
  const Planes limits_of_a = limits_by(noisy.half_b, noisy.variance),
               limits_of_b = limits_by(noisy.half_a, noisy.variance);
  limit(limits_of_a, noisy.half_a, noisy.color);
  limit(limits_of_b, noisy.half_b, noisy.color);
  return noisy;
}

}  // namespace penumbra
