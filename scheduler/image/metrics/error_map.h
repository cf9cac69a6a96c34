// The error of each pixel, and an image of it.
#pragma once

#include <string>
#include <vector>

#include "scheduler/image/metrics/image_pair.h"

namespace penumbra {

/// One number per pixel of `window`, row by row; NaN where an image is not finite.
struct ErrorMap {
  std::string name;  ///< relmse, abs, flip, z
  PixelWindow window;
  std::vector<float> values;
};

/// The mean over channels of d^2 / (B^2 + epsilon), and of |d|.
ErrorMap relative_error_map(const ImagePair& pair, double epsilon);
ErrorMap absolute_error_map(const ImagePair& pair);
/// The largest |z| over the channels, from z_values(); 0 if a pixel has none.
ErrorMap z_map(const ImagePair& pair, const std::vector<float>& z);

/// The values of the darkest and the brightest colour, low < high. A logarithmic range needs low > 0.
struct MapRange {
  double low = 0, high = 1;
  bool logarithmic = false;

  /// Where the value lies between low, 0, and high, 1; may be outside of that.
  [[nodiscard]] double position(double value) const;
  /// The same end on a logarithmic scale of four decades.
  [[nodiscard]] MapRange on_logarithmic_scale() const { return {high * 1e-4, high, true}; }
};
/// The default range of the colours: 0 to 1 for flip, 0 to 5 for z. For others 0 to the 99th percentile (or
/// to the largest value if that is 0), so that a few fireflies do not make the rest black.
MapRange default_range(const ErrorMap& map);

/// The image of a map: heat_color of range.position as linear R, G, B, and the values
/// themselves as NAME.Y. NaN gets kNoValueColor.
Image heat_map_image(const ErrorMap& map, const MapRange& range);

}  // namespace penumbra
