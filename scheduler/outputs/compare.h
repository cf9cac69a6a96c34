// How far an image is from a reference.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "kernels/host/error.h"
#include "scheduler/outputs/image.h"

namespace penumbra {

/// Over the R, G, B values of all pixels where both images are finite; d is image minus reference.
struct Comparison {
  int width = 0, height = 0;
  double relative_mse = 0;    ///< mean of d^2 / (reference^2 + 0.01)
  double mse = 0;             ///< mean of d^2
  double max_difference = 0;  ///< largest |d|
  int max_x = 0, max_y = 0;   ///< where that is, from the corner of the data window
  std::array<double, 3> image_mean{};
  std::array<double, 3> reference_mean{};
  std::uint64_t compared_pixels = 0;
  std::uint64_t image_non_finite = 0;      ///< pixels with a NaN or an infinity, left out of everything above
  std::uint64_t reference_non_finite = 0;  ///< likewise; a pixel may count in both

  /// image mean / reference mean of a channel; NaN where both are 0.
  [[nodiscard]] double mean_ratio(int channel) const;
};

/// Errors: the sizes of the data windows differ, one has no R, G, B channels, no pixel is finite in both.
Expected<Comparison> compare_images(const Image& image, const Image& reference);

/// The comparison in words, several lines, for people.
std::string comparison_text(const Comparison& comparison);
nlohmann::ordered_json comparison_json(const Comparison& comparison);

}  // namespace penumbra
