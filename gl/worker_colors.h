// A colour for each worker, used for its tile's outline and in the panel.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace penumbra {

/// sRGB signal in [0, 1]. Hues differ by the golden ratio, so that consecutive numbers have very different
/// colours.
inline std::array<float, 3> worker_color(std::uint32_t number) {
  const double hue = std::fmod(0.12 + 0.6180339887498949 * double(number), 1.0);
  std::array<float, 3> color{};
  for (int c = 0; c < 3; ++c) {
    const double distance = std::abs(std::fmod(hue * 6 + 4.0 * c, 6.0) - 3) - 1;  // a ramp on the hue circle
    color[std::size_t(c)] = float(1 - 0.65 * (1 - std::fmin(std::fmax(distance, 0.0), 1.0)));
  }
  return color;
}

}  // namespace penumbra
