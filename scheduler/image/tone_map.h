// From linear radiance to the bytes of a PNG.
#pragma once

#include <cstdint>

namespace penumbra {

/// The sRGB transfer function (IEC 61966-2-1): linear light in [0, 1] to a signal in [0, 1].
double srgb_from_linear(double linear);

/// One channel of a PNG: exposure 0, clamped to [0, 1] (NaN is 0), sRGB transfer, rounded to the nearest of
/// 0…255. A plain clamp, so that a PNG shows the EXR's own values wherever the display can.
std::uint8_t display_byte(float linear);

}  // namespace penumbra
