// Spot lights: the radiant intensity falls off between two angles to an axis, linearly in the angle
// (Mitsuba), or as a cubic (pbrt) or quadratic (glTF) function of the cosine. A texture may multiply it. Rays
// never hit them.
#ifndef PENUMBRA_SPOT_LIGHT_H
#define PENUMBRA_SPOT_LIGHT_H
#include "kernels/light/beam.h"

PENUMBRA_NAMESPACE_BEGIN

/// The fraction of the intensity that is emitted in the unit direction w. Angles are computed from sines, and
/// 1 - cosine from squared sines, so that narrow beams keep their digits.
FN float spot_falloff(GLOBAL const Beam* beam, vec3 w) {
  const float x = dot3(load3(&beam->x), w), y = dot3(load3(&beam->y), w), z = dot3(load3(&beam->z), w);
  const float sine2 = sqr(x) + sqr(y);
  const float versine = z > 0.0f ? sine2 / (1.0f + z) : 1.0f - z;
  const int falloff = beam->falloff;
  const float off = falloff == SPOT_LINEAR ? atan2_f(SQRT(sine2), z) : versine;
  const float t = clamp_f((beam->cutoff - off) * beam->inverse_width, 0.0f, 1.0f);
  const float fallen =
      falloff == SPOT_LINEAR ? t : sqr(t) * (falloff == SPOT_SQUARED ? 1.0f : 3.0f - 2.0f * t);
  return off <= beam->beam_width ? 1.0f : fallen;
}

/// Radiant intensity without the texture.
FN vec3 spot_light_radiance(const PRIVATE Scene* scene, GLOBAL const Light* light, LightPoint at, vec3 wi) {
  return scale(load3(&light->radiance), spot_falloff(beam_of(scene, light), negate(wi)));
}

SAMPLE_LIGHT_BY_BEAM(spot)

NO_RAY_FINDS_LIGHT(spot)

PENUMBRA_NAMESPACE_END
#endif
