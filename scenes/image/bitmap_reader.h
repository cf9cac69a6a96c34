// Bitmaps from image files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/image/bitmap.h"

namespace penumbra {

constexpr std::size_t kMaxBitmapBytes = std::size_t{2} << 30;

/// What a bitmap is made of: its colours, or one channel as grey.
enum class BitmapChannels { kAll, kRed, kGreen, kBlue, kAlpha };

struct BitmapFindings {
  std::size_t not_finite = 0;    ///< values: 0 stands in for them
  std::size_t outside_unit = 0;  ///< values below 0 or above 1
  int first_x = 0, first_y = 0;  ///< of the first that is not finite
};

/// What is to be warned of, in words; `reflects`: values are colours of surfaces.
std::vector<std::string> describe(const BitmapFindings& findings, const std::string& name,
                                  bool reflects = true);

/// A bitmap from the contents of an image file of that name, colours as they are encoded; their alpha is left
/// out. Errors, which say the name: of no format that OpenImageIO reads, no texels, more than
/// kMaxBitmapBytes, broken, channels that are neither Y nor R, G, B (with A or without), not the one that is
/// wanted.
Expected<Bitmap> read_bitmap(const std::string& name, std::string_view contents, BitmapChannels channels,
                             BitmapFindings& findings);

}  // namespace penumbra
