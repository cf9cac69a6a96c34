// Directional lights: irradiance perpendicular to one direction, from infinity. Rays never hit them.
#ifndef PENUMBRA_DIRECTIONAL_LIGHT_H
#define PENUMBRA_DIRECTIONAL_LIGHT_H
#include "kernels/light/kind_functions.h"

PENUMBRA_NAMESPACE_BEGIN

/// Irradiance on a surface perpendicular to the direction.
LIGHT_EMITS_UNIFORMLY(directional)

FN LightSample sample_directional_light(const PRIVATE Scene* scene, int index, LightReceiver r, float u,
                                        float v, LightSampling sampling, ulong strategies) {
  GLOBAL const Light* light = scene->lights + index;
  LightSample s = toward_infinity(r, negate(load3(&light->p1)));
  s.pdf = 1.0f;
  s.delta = true;
  s.radiance = directional_light_radiance(scene, light, light_point(s.origin, negate(s.wi)), s.wi);
  return s;
}

NO_RAY_FINDS_LIGHT(directional)

PENUMBRA_NAMESPACE_END
#endif
