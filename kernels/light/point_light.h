// Point lights. Rays never hit them.
#ifndef PENUMBRA_POINT_LIGHT_H
#define PENUMBRA_POINT_LIGHT_H
#include "kernels/light/kind_functions.h"

PENUMBRA_NAMESPACE_BEGIN

/// Radiant intensity.
LIGHT_EMITS_UNIFORMLY(point)

FN LightSample sample_point_light(const PRIVATE Scene* scene, int index, LightReceiver r, float u, float v,
                                  LightSampling sampling, ulong strategies) {
  GLOBAL const Light* light = scene->lights + index;
  float inverse_d2;
  LightSample s = toward_delta_point(light, r, &inverse_d2);
  const LightPoint at = light_point(load3(&light->p0), negate(s.wi));
  s.radiance = scale(point_light_radiance(scene, light, at, s.wi), inverse_d2);
  return s;
}

NO_RAY_FINDS_LIGHT(point)

PENUMBRA_NAMESPACE_END
#endif
