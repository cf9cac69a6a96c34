// Reads bitmaps from image files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/image/bitmap.h"

namespace penumbra {

constexpr std::size_t kMaxBitmapBytes = std::size_t{2} << 30;

/// The channels of a bitmap: all colours, or one channel as grey.
enum class BitmapChannels { kAll, kRed, kGreen, kBlue, kAlpha };

struct BitmapFindings {
  std::size_t not_finite = 0;    ///< number of values that were replaced by 0
  std::size_t outside_unit = 0;  ///< number of values below 0 or above 1
  int first_x = 0, first_y = 0;  ///< position of the first value that is not finite
};

/// The warnings, in words. `reflects`: the values are reflectances.
std::vector<std::string> describe(const BitmapFindings& findings, const std::string& name,
                                  bool reflects = true);

/// A bitmap from the contents of an image file. Colours stay encoded; their alpha is dropped. Errors, with
/// the file's name: a format that OpenImageIO does not read, no texels, more than kMaxBitmapBytes, damaged
/// data, channels other than Y or R, G, B (each with or without A), no channel of the kind requested.
Expected<Bitmap> read_bitmap(const std::string& name, std::string_view contents, BitmapChannels channels,
                             BitmapFindings& findings);

}  // namespace penumbra
