// Colour spaces of the perceptual metric and of the heat map: linear Rec. 709 (the primaries of sRGB, white
// D65), CIE XYZ relative to white, CIELAB.
#pragma once

#include "kernels/host/chromaticities.h"

namespace penumbra {

/// Converts linear RGB to XYZ / XYZ of white: (1, 1, 1) becomes (1, 1, 1). Derived from the chromaticities of
/// Rec. 709.
Color relative_xyz_from_rgb(const Color& rgb);
Color rgb_from_relative_xyz(const Color& xyz);

/// The relative luminance: Y of relative_xyz_from_rgb.
double luminance(const Color& rgb);

/// CIELAB (CIE 15:2004, 8.2.1): L* from 0 to 100, a*, b*.
Color lab_from_relative_xyz(const Color& xyz);
Color relative_xyz_from_lab(const Color& lab);

/// The inverse of srgb_from_linear (tone_map.h): a signal in [0, 1] to linear light in [0, 1].
double linear_from_srgb(double signal);

}  // namespace penumbra
