// A sequential colour map: dark is low, light is high.
#pragma once

#include <array>

namespace penumbra {

/// Linear RGB in [0, 1] for t, which is clamped to [0, 1] (NaN: 0). The path through CIELAB goes from dark
/// purple through blue and green to yellow with lightness L* = 12 + 80 t. So equal steps of t are equal steps
/// of lightness, also in grey print and for colour-blind readers.
std::array<float, 3> heat_color(double t);

/// The colour of pixels without a value; not on the path above.
constexpr std::array<float, 3> kNoValueColor{1, 0, 1};

}  // namespace penumbra
