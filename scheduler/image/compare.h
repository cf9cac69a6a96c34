// Compares an image with a reference: everything that `penumbra compare` reports, and its limits on metrics.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"
#include "scheduler/image/metrics/error_map.h"
#include "scheduler/image/metrics/error_metrics.h"
#include "scheduler/image/metrics/flip.h"
#include "scheduler/image/metrics/z_test.h"

namespace penumbra {

enum class FlipKind {
  /// Depends on the images: LDR-FLIP for two sRGB images, HDR-FLIP for two linear ones, none for other
  /// layers.
  kAuto,
  kDisplay,   ///< LDR-FLIP, values as sRGB signals
  kRadiance,  ///< HDR-FLIP, values as linear radiance
  kNone
};

/// What the z-test and the variances on which it depends say about two images.
enum class Verdict {
  kAgree,        ///< no difference at the significance
  kDiffer,       ///< a difference at the significance
  kInconclusive  ///< variances are missing, from too few samples, or do not describe the noise
};

struct CompareOptions {
  std::string layer;                  ///< see layer_channels
  double epsilon = kRelativeEpsilon;  ///< epsilon of relMSE, MAPE and SMAPE
  FlipKind flip = FlipKind::kAuto;
  double pixels_per_degree = kFlipPixelsPerDegree;
  ZTestOptions z_test;
  bool exact_reference = false;  ///< a reference without variances has no noise
};

/// The images to compare. Null: there is none.
struct CompareImages {
  const Image& image;
  const Image& reference;
  const Image* second_reference = nullptr;  ///< independent of the first, with as many samples
  const Image* variance = nullptr;  ///< the variance of the image's values; used instead of its own layer
  /// Likewise for the reference; with two references the variance of their mean.
  const Image* reference_variance = nullptr;
};

/// The results. For their definitions see error_metrics.h, flip.h and z_test.h.
struct Comparison {
  std::string layer;
  ImagePair pair;
  double epsilon = 0;
  std::uint64_t trimmed_pixels = 0;
  ChannelValues image_mean, reference_mean;
  ChannelValues bias, relative_bias, mse, relative_mse, trimmed_relative_mse, block_relative_mse, mape, smape,
      psnr, largest;
  LargestDifference largest_at;
  std::optional<FlipResult> flip;
  std::string flip_left_out;  ///< why FLIP was not computed
  std::optional<ZTest> z_test;
  std::string z_test_left_out;
  /// Used by the z-test: variances, and the numbers of samples from which they are estimated.
  std::vector<float> image_variance, reference_variance, image_samples, reference_samples;
  Verdict verdict = Verdict::kInconclusive;
  std::string verdict_reason;  ///< of the verdict, in words

  [[nodiscard]] ImageNoise image_noise() const { return {image_variance, image_samples}; }
  [[nodiscard]] ImageNoise reference_noise() const { return {reference_variance, reference_samples}; }

  /// image mean / reference mean of a channel; NaN if both are 0.
  [[nodiscard]] double mean_ratio(std::size_t channel) const;
};

/// Errors: those of pair_images, and of flip_of_display_images and z_test if they were explicitly requested;
/// a variance image that does not match; one image is linear and another one display-referred.
Expected<Comparison> compare_images(const CompareImages& images, const CompareOptions& options = {});

/// The error map of that name: relmse, abs, flip or z. Errors: another name; no FLIP or no variance
/// available.
Expected<ErrorMap> error_map(const Comparison& comparison, const std::string& name);

/// Sets the verdict from the z-test.
void set_verdict(const CompareImages& images, const CompareOptions& options, Comparison& comparison);
/// agree, differ or inconclusive.
const char* verdict_name(Verdict verdict);

/// The comparison as text of several lines.
std::string comparison_text(const Comparison& comparison);
nlohmann::ordered_json comparison_json(const Comparison& comparison);

struct CompareLimit {
  std::string metric;  ///< one of limit_metrics()
  double value = 0;    ///< the largest acceptable value
};

/// The names of metrics that can have a limit.
std::vector<std::string> limit_metrics();

/// Parses "METRIC=VALUE". Errors: another form, an unknown metric, a value that is negative or not finite.
Expected<CompareLimit> parse_limit(std::string_view text);

/// The metric over all channels. For bias and relative_bias it is the largest magnitude of a channel, so that
/// signs do not cancel. Errors: the metric was not computed; the message says why.
Expected<double> limited_value(const Comparison& comparison, std::string_view metric);

}  // namespace penumbra
