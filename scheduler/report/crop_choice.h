// Chooses the part of an image that the equal-time crops show.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

struct CropChoice {
  enum class Kind { kLargestError, kCentre, kPlace } kind = Kind::kLargestError;
  int x = 0, y = 0;  ///< for kPlace: the corner in film pixels
  int size = 0;      ///< side of the square; 0: a third of the image's shorter side, but at least 16
};

/// Parses "error", "centre", "error:SIZE", "centre:SIZE" or "X,Y,SIZE".
Expected<CropChoice> parse_crop_choice(std::string_view text);

struct ChosenCrop {
  PixelWindow window;
  std::string why;  ///< for display
};

/// The square, moved and shrunk to lie in `window`. `errors` has one number per pixel of it, row by row; NaN
/// is treated as 0. For kLargestError it is the square with the largest sum of errors, each clamped to the
/// 99th percentile, so that a single firefly does not determine it.
ChosenCrop choose_crop(const CropChoice& choice, const PixelWindow& window,
                       const std::vector<double>& errors);

}  // namespace penumbra
