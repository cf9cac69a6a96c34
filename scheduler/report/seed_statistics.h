// Splits the error of several images that differ only in their seeds into noise and bias.
#pragma once

#include <cstdint>
#include <vector>

#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {

/// error = bias_squared + variance. Each is a mean over pixels and channels, and an unbiased estimate. For R
/// images x_r with mean x and variance s^2 (of one image, with divisor R - 1), and references A and B:
///      error         mean over r of (x_r - A)(x_r - B) w
///      variance      s^2 w
///      bias_squared  ((x - A)(x - B) - s^2 / R) w
/// With a single reference, B is A, and its noise counts as bias. Estimates of 0 may be negative.
struct ErrorSplit {
  double error = 0, variance = 0, bias_squared = 0;
  /// Standard error of `bias_squared`, from the noise of images and references in each pixel. Pixels are
  /// assumed to be independent, and the channels of a pixel to be fully correlated, which is nearly true for
  /// rendering noise.
  double bias_squared_error = 0;
};

class SeedStatistics {
 public:
  /// Adds an image. All pairs must have the same references, sizes and channels. Pixels that are not finite
  /// in any image are left out.
  void add(const ImagePair& pair);

  [[nodiscard]] int seeds() const { return seeds_; }
  /// The split with w = 1. With one image only `error` is known; the other values are NaN.
  [[nodiscard]] ErrorSplit squared() const { return split(false, 0); }
  /// The split with w = 1 / (truth^2 + epsilon), where truth is the mean of the references.
  [[nodiscard]] ErrorSplit relative(double epsilon) const { return split(true, epsilon); }

 private:
  [[nodiscard]] ErrorSplit split(bool weighted, double epsilon) const;

  int seeds_ = 0;
  ImagePair references_;  // only its references are used
  std::vector<std::uint8_t> finite_;
  std::vector<double> mean_, m2_;
};

}  // namespace penumbra
