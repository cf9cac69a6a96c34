// Where images differ: an error for each pixel, and a picture of it.
#pragma once

#include <string>
#include <vector>

#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {

/// One number for each pixel of `window`, row by row; NaN where the images are not finite.
struct ErrorMap {
  std::string name;  ///< relmse, abs, flip, z
  PixelWindow window;
  std::vector<float> values;
};

/// Mean over channels of d^2 / (B^2 + epsilon); of |d|.
ErrorMap relative_error_map(const ImagePair& pair, double epsilon);
ErrorMap absolute_error_map(const ImagePair& pair);
/// The largest |z| of the channels, from z_values(); 0 where there is none.
ErrorMap z_map(const ImagePair& pair, const std::vector<float>& z);

struct MapRange {
  double low = 0, high = 1;
};
/// What the colours show unless told otherwise: 0 to 1 for flip, 0 to 5 for z, and 0 to the 99th percentile
/// (so that a few fireflies do not turn the rest black; the largest value if that is 0) of the others.
MapRange default_range(const ErrorMap& map);

/// heat_color of (value - low) / (high - low) as channels R, G, B, linear, and the values themselves as
/// NAME.Y. What is NaN has kNoValueColor.
Image heat_map_image(const ErrorMap& map, const MapRange& range);

}  // namespace penumbra
