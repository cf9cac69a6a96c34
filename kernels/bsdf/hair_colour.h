// The absorption that gives a mass of hair its colour (Chiang et al. 2016, equation 9).
#ifndef PENUMBRA_HAIR_COLOUR_H
#define PENUMBRA_HAIR_COLOUR_H
#include "kernels/math/math.h"

PENUMBRA_NAMESPACE_BEGIN

/// Factor of sqrt(sigma_a) in the logarithm of the colour for an azimuthal roughness.
FN float hair_colour_factor(float beta_n) {
  const float b = beta_n;
  return 5.969f + b * (-0.215f + b * (2.532f + b * (-10.73f + b * (5.574f + b * 0.245f))));
}
FN float hair_absorption_of(float colour, float factor) {
  return sqr(log_f(clamp_f(colour, 1e-30f, 1.0f)) / factor);
}

/// Lower values mean this one, as in pbrt.
#define LEAST_HAIR_ROUGHNESS 0.01f

PENUMBRA_NAMESPACE_END
#endif
