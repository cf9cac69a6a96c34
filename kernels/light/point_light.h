// Point lights, which no ray finds.
#ifndef PENUMBRA_POINT_LIGHT_H
#define PENUMBRA_POINT_LIGHT_H
#include "kernels/light/light_found.h"

PENUMBRA_NAMESPACE_BEGIN

/// Radiant intensity.
FN vec3 point_light_radiance(const PRIVATE Scene* scene, GLOBAL const Light* light, LightPoint at, vec3 wi) {
  return load3(&light->radiance);
}

FN LightSample sample_point_light(const PRIVATE Scene* scene, int index, LightReceiver r, float u, float v,
                                  LightSampling sampling, uint ways) {
  GLOBAL const Light* light = scene->lights + index;
  const vec3 p = load3(&light->p0);
  float d2;
  LightSample s = toward_point(r, p, &d2);
  s.pdf = 1.0f;
  s.delta = true;
  s.radiance = scale(point_light_radiance(scene, light, light_point(p, negate(s.wi)), s.wi), 1.0f / d2);
  return s;
}

FN float point_light_pdf(const PRIVATE Scene* scene, GLOBAL const Light* light, FoundLight found, uint ways) {
  return 0.0f;
}

PENUMBRA_NAMESPACE_END
#endif
