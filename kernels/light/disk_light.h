// Disk lights, by area.
#ifndef PENUMBRA_DISK_LIGHT_H
#define PENUMBRA_DISK_LIGHT_H
#include "kernels/light/light_found.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

FN vec3 disk_light_radiance(const PRIVATE Scene* scene, GLOBAL const Light* light, LightPoint at, vec3 wi) {
  return load3(&light->radiance);
}

FN LightSample sample_disk_light(const PRIVATE Scene* scene, GLOBAL const Light* light, LightReceiver r,
                                 float u, float v, LightSampling sampling, uint ways) {
  const vec3 center = load3(&light->p0);
  const float radius = light->p2.x, root = SQRT(u);
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  LightPoint at;
  at.normal = load3(&light->p1);
  at.p = add(center, from_frame(at.normal, radius * root * cosine, radius * root * sine, 0.0f));
  const float spread = dot3(abs3(at.normal), add(abs3(center), make_vec3(radius, radius, radius)));
  LightSample s = toward_light(light, r, at, spread, 0.0f);
  s.radiance = disk_light_radiance(scene, light, at, s.wi);
  return s;
}

FN float disk_light_pdf(const PRIVATE Scene* scene, GLOBAL const Light* light, FoundLight found, uint ways) {
  return area_to_solid_angle(sqr(found.distance), found.cosine, light->area);
}

PENUMBRA_NAMESPACE_END
#endif
