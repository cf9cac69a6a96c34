// Converts linear radiance to what a display shows: tone maps, and the bytes of a PNG.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "kernels/host/chromaticities.h"

namespace penumbra {

/// How radiance of any brightness becomes linear light of a display, in [0, 1].
enum class ToneOperator { kClamp, kReinhard, kFilmic, kAces };

/// The names of command lines, in the order of ToneOperator.
constexpr std::array<std::string_view, 4> kToneOperatorNames{"clamp", "reinhard", "filmic", "aces"};

/// Hable's curve, not yet divided by its value for white: J. Hable, "Filmic Tonemapping Operators" (2010) and
/// "Uncharted 2: HDR Lighting" (GDC 2010), with A = 0.15, B = 0.50, C = 0.10, D = 0.20, E = 0.02, F = 0.30.
constexpr double hable_curve(double x) {
  return (x * (0.15 * x + 0.50 * 0.10) + 0.20 * 0.02) / (x * (0.15 * x + 0.50) + 0.20 * 0.30) - 0.02 / 0.30;
}

/// Linear light in [0, 1] of linear Rec. 709 radiance x, which is already exposed. Negative values and NaN
/// count as 0, and the result is clamped.
///   kClamp     x
///   kReinhard  x / (1 + L), L the luminance of Rec. 709: E. Reinhard et al., "Photographic Tone Reproduction
///              for Digital Images" (2002), equation 3
///   kFilmic    h(2 x) / h(11.2), h the hable_curve: as published, with its exposure of 2 and white at 11.2,
///              so x = 5.6 is white
///   kAces      x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14): K. Narkowicz, "ACES Filmic Tone Mapping
///   Curve"
///              (2015), without the factor 0.6 before it
constexpr Color tone_mapped(ToneOperator tone, const Color& radiance) {
  Color mapped{};
  for (std::size_t c = 0; c < 3; ++c) mapped[c] = radiance[c] > 0 ? std::min(radiance[c], 1e30) : 0.0;
  const double luminance = 0.2126 * mapped[0] + 0.7152 * mapped[1] + 0.0722 * mapped[2];
  for (double& x : mapped) {
    if (tone == ToneOperator::kReinhard) x /= 1 + luminance;
    if (tone == ToneOperator::kFilmic) x = hable_curve(2 * x) / hable_curve(11.2);
    if (tone == ToneOperator::kAces) x = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    x = std::min(x, 1.0);
  }
  return mapped;
}

/// The sRGB transfer function (IEC 61966-2-1), from linear light in [0, 1] to a signal in [0, 1].
double srgb_from_linear(double linear);

/// One channel of a PNG: clamped to [0, 1] (NaN becomes 0), sRGB transfer, rounded to 0…255.
/// Values are only clamped, so a PNG shows the EXR's own values wherever the display can.
std::uint8_t display_byte(float linear);

}  // namespace penumbra
