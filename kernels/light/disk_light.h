// Disk lights, sampled by area.
#ifndef PENUMBRA_DISK_LIGHT_H
#define PENUMBRA_DISK_LIGHT_H
#include "kernels/intersect/surface_uv.h"
#include "kernels/light/kind_functions.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

LIGHT_EMITS_UNIFORMLY(disk)

FN SampledPoint sample_disk_point(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                  LightReceiver r, float u, float v, ulong strategies) {
  const vec3 center = light.p0, normal = light.p1;
  const float radius = light.p2.x, root = SQRT(u);
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const vec3 from_center = from_frame(normal, radius * root * cosine, radius * root * sine, 0.0f);
  SampledPoint s;
  s.at = light_point(add(center, from_center), normal);
  s.spread = dot3(abs3(normal), add(abs3(center), make_vec3(radius, radius, radius)));
  s.pdf = 0.0f;
  if (BY(strategies, UV)) {
    const TexturePoint on = disk_uv(to_light_axes(axes, from_center), radius);
    s.at.u = on.u;
    s.at.v = on.v;
  }
  return s;
}

SAMPLE_LIGHT_BY_POINT(disk)

FIND_LIGHT_BY_AREA(disk)

PENUMBRA_NAMESPACE_END
#endif
