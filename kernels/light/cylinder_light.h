// Cylinder lights, sampled by area.
#ifndef PENUMBRA_CYLINDER_LIGHT_H
#define PENUMBRA_CYLINDER_LIGHT_H
#include "kernels/intersect/surface_uv.h"
#include "kernels/light/kind_functions.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

LIGHT_EMITS_UNIFORMLY(cylinder)

FN SampledPoint sample_cylinder_point(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                      LightReceiver r, float u, float v, ulong strategies) {
  const vec3 center = light.p0, axis = light.p1;
  const float radius = light.p2.x, orientation = light.p2.y, length = light.p2.z;
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const vec3 outward = from_frame(axis, cosine, sine, 0.0f);
  const vec3 from_center = add_scaled(scale(outward, radius), u * length, axis);
  SampledPoint s;
  s.at = light_point(add(center, from_center), scale(outward, orientation));
  const float reach = radius + length;
  s.spread = dot3(abs3(outward), add(abs3(center), make_vec3(reach, reach, reach)));
  s.pdf = 0.0f;
  if (BY(strategies, UV)) {
    const TexturePoint on = cylinder_uv(to_light_axes(axes, from_center), length);
    s.at.u = on.u;
    s.at.v = on.v;
  }
  return s;
}

SAMPLE_LIGHT_BY_POINT(cylinder)

FIND_LIGHT_BY_AREA(cylinder)

PENUMBRA_NAMESPACE_END
#endif
