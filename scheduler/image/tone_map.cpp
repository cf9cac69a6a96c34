#include "scheduler/image/tone_map.h"

#include <algorithm>
#include <cmath>

namespace penumbra {

double srgb_from_linear(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

std::uint8_t display_byte(float linear) {
  if (!(linear > 0.0f)) return 0;
  return std::uint8_t(std::lround(255.0 * srgb_from_linear(std::min(double(linear), 1.0))));
}

}  // namespace penumbra
