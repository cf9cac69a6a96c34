// Directional lights, which no ray finds: irradiance across one direction, from beyond the scene.
#ifndef PENUMBRA_DIRECTIONAL_LIGHT_H
#define PENUMBRA_DIRECTIONAL_LIGHT_H
#include "kernels/light/light_found.h"

PENUMBRA_NAMESPACE_BEGIN

/// Irradiance on a surface across the direction.
FN vec3 directional_light_radiance(const PRIVATE Scene* scene, GLOBAL const Light* light, LightPoint at,
                                   vec3 wi) {
  return load3(&light->radiance);
}

FN LightSample sample_directional_light(const PRIVATE Scene* scene, int index, LightReceiver r, float u,
                                        float v, LightSampling sampling, uint ways) {
  GLOBAL const Light* light = scene->lights + index;
  LightSample s = no_light_sample();
  s.wi = s.toward = negate(load3(&light->p1));
  s.origin = leave_surface(r.p, r.geometric, r.error, s.wi);
  s.tmax = NO_LIMIT;
  s.pdf = 1.0f;
  s.delta = true;
  s.radiance = directional_light_radiance(scene, light, light_point(s.origin, negate(s.wi)), s.wi);
  return s;
}

FN float directional_light_pdf(const PRIVATE Scene* scene, GLOBAL const Light* light, FoundLight found,
                               uint ways) {
  return 0.0f;
}

PENUMBRA_NAMESPACE_END
#endif
