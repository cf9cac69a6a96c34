// Projectors: an image in focus at every distance (Mitsuba 3). Rays never hit them. `radiance` times the
// texture is the irradiance over pi on a plane at distance 1 perpendicular to the beam.
#ifndef PENUMBRA_PROJECTOR_LIGHT_H
#define PENUMBRA_PROJECTOR_LIGHT_H
#include "kernels/light/beam.h"

PENUMBRA_NAMESPACE_BEGIN

/// Radiant intensity without the texture. A point of that plane is at distance 1 / cos and sees the light
/// under that cosine, hence 1 / cos^3.
FN vec3 projector_light_radiance(const PRIVATE Scene* scene, GLOBAL const Light* light, LightPoint at,
                                 vec3 wi) {
  const float cosine = -dot3(load3(&beam_of(scene, light)->z), wi);
  const bool within = (cosine > 0.0f) & (at.u >= 0.0f) & (at.u <= 1.0f) & (at.v >= 0.0f) & (at.v <= 1.0f);
  const float divisor = within ? cosine * sqr(cosine) : 1.0f;
  return scale(load3(&light->radiance), within ? PI_F / divisor : 0.0f);
}

SAMPLE_LIGHT_BY_BEAM(projector)

NO_RAY_FINDS_LIGHT(projector)

PENUMBRA_NAMESPACE_END
#endif
