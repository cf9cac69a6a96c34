// How far an image is from a reference: everything that `penumbra compare` reports.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"
#include "scheduler/image/metrics/error_map.h"
#include "scheduler/image/metrics/error_metrics.h"
#include "scheduler/image/metrics/flip.h"
#include "scheduler/image/metrics/z_test.h"

namespace penumbra {

enum class FlipKind {
  kAuto,  ///< by the images: LDR for two sRGB images, HDR for two linear ones, none for one of each or other
          ///< layers
  kDisplay,   ///< LDR-FLIP, values as sRGB signals
  kRadiance,  ///< HDR-FLIP, values as linear radiance
  kNone
};

struct CompareOptions {
  std::string layer;                  ///< see layer_channels
  double epsilon = kRelativeEpsilon;  ///< of relMSE, MAPE and SMAPE
  FlipKind flip = FlipKind::kAuto;
  double pixels_per_degree = kFlipPixelsPerDegree;
  ZTestOptions z_test;
};

/// What is compared. Null pointers: there is none.
struct CompareImages {
  const Image& image;
  const Image& reference;
  const Image* second_reference = nullptr;    ///< independent of the first, of as many samples
  const Image* variance = nullptr;            ///< of the image's values, instead of its own layer
  const Image* reference_variance = nullptr;  ///< likewise; of the mean of both where there are two
};

/// See error_metrics.h, flip.h and z_test.h for what each is.
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
  std::string flip_left_out;  ///< why there is none
  std::optional<ZTest> z_test;
  std::string z_test_left_out;
  std::vector<float> image_variance, reference_variance;  ///< as the z-test takes them

  /// image mean / reference mean of a channel; NaN where both are 0.
  [[nodiscard]] double mean_ratio(std::size_t channel) const;
};

/// Errors: those of pair_images, flip_of_display_images and z_test where they were asked for, a variance
/// image that does not fit.
Expected<Comparison> compare_images(const CompareImages& images, const CompareOptions& options = {});

/// The map of that name: relmse, abs, flip or z. Errors: another name, no FLIP or no variance.
Expected<ErrorMap> error_map(const Comparison& comparison, const std::string& name);

/// The comparison in words, several lines, for people.
std::string comparison_text(const Comparison& comparison);
nlohmann::ordered_json comparison_json(const Comparison& comparison);

}  // namespace penumbra
