// A sequential colour map: dark is low, light is high.
#pragma once

#include <array>

namespace penumbra {

/// Linear RGB in [0, 1] for t, clamped to [0, 1] (NaN: 0). A path through CIELAB from dark purple through
/// blue and green to yellow: lightness L* = 12 + 80 t, so equal steps of t are equal steps of lightness, in
/// grey print and for the colour-blind too.
std::array<float, 3> heat_color(double t);

/// Marks pixels that have no value; not on the path above.
constexpr std::array<float, 3> kNoValueColor{1, 0, 1};

}  // namespace penumbra
