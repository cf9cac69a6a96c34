// Several images of one method, alike but for their seeds: how much of their error is noise, how much bias.
#pragma once

#include <cstdint>
#include <vector>

#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {

/// error = bias_squared + variance, each a mean over pixels and channels, and estimated without bias: R
/// images x_r with mean x and variance s^2 (of one image, over R - 1), references A and B:
///   error         mean over r of (x_r - A)(x_r - B) w
///   variance      s^2 w
///   bias_squared  ((x - A)(x - B) - s^2 / R) w
/// With one reference A stands for B, and its noise counts as bias. Estimates of what is 0 may be negative.
struct ErrorSplit {
  double error = 0, variance = 0, bias_squared = 0;
  /// Standard error of `bias_squared`, from the noise of images and references in each pixel. Pixels count as
  /// independent, the channels of one as fully correlated, which colour noise nearly is.
  double bias_squared_error = 0;
};

class SeedStatistics {
 public:
  /// All pairs have the same references, sizes and channels; pixels that are not finite in one are left out.
  void add(const ImagePair& pair);

  [[nodiscard]] int seeds() const { return seeds_; }
  /// w = 1. With one image there is no split: the variance and the rest but `error` are NaN.
  [[nodiscard]] ErrorSplit squared() const { return split(false, 0); }
  /// w = 1 / (truth^2 + epsilon), truth the mean of the references.
  [[nodiscard]] ErrorSplit relative(double epsilon) const { return split(true, epsilon); }

 private:
  [[nodiscard]] ErrorSplit split(bool weighted, double epsilon) const;

  int seeds_ = 0;
  ImagePair references_;  // its image is not used
  std::vector<std::uint8_t> finite_;
  std::vector<double> mean_, m2_;
};

}  // namespace penumbra
