// Denoises images: non-local means (Rousselle et al. 2012) and first-order regression (NFOR, Bitterli et al.
// 2016).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/denoise/denoise_device.h"

namespace penumbra {

// Images as planes of floats.

/// Plane k of pixel (x, y) is values[(k * height + y) * width + x].
struct Planes {
  Planes() = default;
  Planes(int w, int h, int planes, float value = 0)
      : width(w), height(h), count(planes), values(std::size_t(planes) * pixels(), value) {}

  int width = 0, height = 0, count = 0;
  std::vector<float> values;

  [[nodiscard]] std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
  [[nodiscard]] std::span<float> plane(int k) {
    return std::span(values).subspan(std::size_t(k) * pixels(), pixels());
  }
  [[nodiscard]] std::span<const float> plane(int k) const {
    return std::span(values).subspan(std::size_t(k) * pixels(), pixels());
  }
};

/// What is known of a noisy image. Values are finite; pixels that are not to be used are 0 in `valid`.
struct DenoiseInput {
  Planes color;     ///< 3 planes: the mean radiance
  Planes variance;  ///< 3 planes: the variance of that mean
  /// 3 planes each: the means of two halves of the samples. Without planes: there are none.
  Planes half_a, half_b;
  Planes features;          ///< REGRESSION_FEATURES planes: albedo, normal, depth; 0 where there are none
  Planes feature_variance;  ///< their variances; 0 where they are not known
  Planes valid;             ///< 1 plane

  [[nodiscard]] bool has_halves() const { return half_a.count > 0; }
};

struct NlMeansOptions {
  int search_radius = 10;  ///< r, at most MAX_SEARCH_RADIUS
  int patch_radius = 3;    ///< f, at most MAX_PATCH_RADIUS
  float strength = 0.45f;  ///< k
  bool operator==(const NlMeansOptions&) const = default;
};

struct DenoisedImage {
  Planes color;  ///< 3 planes
  /// 3 planes: (A - B)^2 / 4 of the two denoised halves, the variance that is left. It does not tell bias.
  /// Without planes: there were no halves.
  Planes residual_variance;
};

/// Outliers are limited (outliers.h), then each half is filtered with the weights of the other. Without
/// halves the image is filtered with its own weights. Errors are those of the device.
Expected<DenoisedImage> nl_means(DenoiseDevice& device, DenoiseInput noisy, const NlMeansOptions& options);

/// First-order regression, without outliers too, on the features, which are filtered first. The bandwidth is
/// chosen by the error that the halves show.
Expected<DenoisedImage> nfor(DenoiseDevice& device, DenoiseInput noisy);

}  // namespace penumbra
