// A constant environment.
#ifndef PENUMBRA_ENVIRONMENT_LIGHT_H
#define PENUMBRA_ENVIRONMENT_LIGHT_H
#include "kernels/light/kind_functions.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

LIGHT_EMITS_UNIFORMLY(environment)

FN LightSample sample_environment_light(const PRIVATE Scene* scene, int index, LightReceiver r, float u,
                                        float v, LightSampling sampling, ulong strategies) {
  GLOBAL const Light* light = scene->lights + index;
  LightSample s = toward_infinity(r, sample_uniform_sphere(u, v));
  s.pdf = 0.25f * INV_PI_F;
  s.radiance = environment_light_radiance(scene, light, light_point(s.origin, negate(s.wi)), s.wi);
  return s;
}

FN float environment_light_pdf(const PRIVATE Scene* scene, GLOBAL const Light* light, FoundLight found,
                               ulong strategies) {
  return 0.25f * INV_PI_F;
}

PENUMBRA_NAMESPACE_END
#endif
