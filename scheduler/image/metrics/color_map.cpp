#include "scheduler/image/metrics/color_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scheduler/image/metrics/color_space.h"

namespace penumbra {

std::array<float, 3> heat_color(double t) {
  t = t > 0 ? std::min(t, 1.0) : 0.0;
  const double lightness = 12 + 80 * t;
  const double hue = (310 - 210 * t) * std::numbers::pi / 180;
  // sRGB has little chroma between blue and green; this amount is inside the gamut on the whole path.
  const double side = 2 * t - 1, square = side * side;
  const double chroma = 24 + (side < 0 ? 28 * square * square : 56 * square);
  const Color rgb = rgb_from_relative_xyz(
      relative_xyz_from_lab({lightness, chroma * std::cos(hue), chroma * std::sin(hue)}));
  return {float(rgb[0]), float(rgb[1]), float(rgb[2])};
}

}  // namespace penumbra
