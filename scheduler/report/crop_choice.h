// Which part of an image the equal-time pictures show.
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
  int x = 0, y = 0;  ///< kPlace: corner, in film pixels
  int size = 0;      ///< side of the square; 0: a third of the image's shorter side, at least 16
};

/// "error", "centre", "error:SIZE", "centre:SIZE", "X,Y,SIZE".
Expected<CropChoice> parse_crop_choice(std::string_view text);

struct ChosenCrop {
  PixelWindow window;
  std::string why;  ///< for people
};

/// The square, moved and shrunk to lie in `window`. `errors` has a number for each pixel of it, row by row;
/// NaN counts as 0. For kLargestError it is where their sum is largest, with each clamped to the 99th
/// percentile, so that a firefly is not all that there is to see.
ChosenCrop choose_crop(const CropChoice& choice, const PixelWindow& window,
                       const std::vector<double>& errors);

}  // namespace penumbra
