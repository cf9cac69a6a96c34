// Converts linear radiance to the bytes of a PNG.
#pragma once

#include <cstdint>

namespace penumbra {

/// The sRGB transfer function (IEC 61966-2-1), from linear light in [0, 1] to a signal in [0, 1].
double srgb_from_linear(double linear);

/// One channel of a PNG: exposure 0, clamped to [0, 1] (NaN becomes 0), sRGB transfer, rounded to 0…255.
/// Values are only clamped, so a PNG shows the EXR's own values wherever the display can.
std::uint8_t display_byte(float linear);

}  // namespace penumbra
