// The environment, the same from all directions.
#ifndef PENUMBRA_ENVIRONMENT_LIGHT_H
#define PENUMBRA_ENVIRONMENT_LIGHT_H
#include "kernels/light/light_found.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

FN vec3 environment_light_radiance(const PRIVATE Scene* scene, GLOBAL const Light* light, LightPoint at,
                                   vec3 wi) {
  return load3(&light->radiance);
}

FN LightSample sample_environment_light(const PRIVATE Scene* scene, int index, LightReceiver r, float u,
                                        float v, LightSampling sampling, uint ways) {
  GLOBAL const Light* light = scene->lights + index;
  LightSample s = no_light_sample();
  s.wi = s.toward = sample_uniform_sphere(u, v);
  s.origin = leave_surface(r.p, r.geometric, r.error, s.wi);
  s.tmax = NO_LIMIT;
  s.pdf = 0.25f * INV_PI_F;
  s.radiance = environment_light_radiance(scene, light, light_point(s.origin, negate(s.wi)), s.wi);
  return s;
}

FN float environment_light_pdf(const PRIVATE Scene* scene, GLOBAL const Light* light, FoundLight found,
                               uint ways) {
  return 0.25f * INV_PI_F;
}

PENUMBRA_NAMESPACE_END
#endif
