// Rectangle lights, sampled by area or by solid angle.
#ifndef PENUMBRA_RECTANGLE_LIGHT_H
#define PENUMBRA_RECTANGLE_LIGHT_H
#include "kernels/light/flat_light.h"
#include "kernels/light/kind_functions.h"
#include "kernels/light/spherical_rectangle.h"

PENUMBRA_NAMESPACE_BEGIN

/// The rectangle as seen from `from`. The solid angle is 0 if the light is not sampled by it.
FN SphericalRectangle seen_rectangle(Light light, vec3 from) {
  const vec3 p0 = sub(light.p0, from), p1 = sub(light.p1, from);
  SphericalRectangle s = spherical_rectangle(p0, p1, sub(light.p2, from));
  const bool wanted = (light.sampling == EMITTER_SOLID_ANGLE) & (s.solid_angle > SMALL_RECTANGLE_SOLID_ANGLE);
  s.solid_angle = wanted ? s.solid_angle : 0.0f;
  return s;
}

LIGHT_EMITS_UNIFORMLY(rectangle)

FN SampledPoint sample_rectangle_point(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                       LightReceiver r, float u, float v, ulong strategies) {
  const FlatLight flat = flat_light(light);
  SampledPoint s = flat_light_point(flat, r.p, (1.0f - u) - v, u, v);
  if (BY(strategies, SOLID_ANGLE)) {
    const SphericalRectangle seen = seen_rectangle(light, r.p);
    const bool use = seen.solid_angle > 0.0f;
    s.at.p = select3(use, flat_light_seen(flat, r.p, sample_spherical_rectangle(seen, u, v)), s.at.p);
    s.pdf = use ? 1.0f / (use ? seen.solid_angle : 1.0f) : 0.0f;
  }
  if (BY(strategies, UV)) s.at = with_flat_uv(scene, index, s.at);
  return s;
}

SAMPLE_LIGHT_BY_POINT(rectangle)

FN float rectangle_light_pdf(const PRIVATE Scene* scene, Light light, FoundLight found, ulong strategies) {
  float pdf = area_to_solid_angle(sqr(found.distance), found.cosine, light.area);
  if (BY(strategies, SOLID_ANGLE)) {
    const float solid_angle = seen_rectangle(light, found.from).solid_angle;
    pdf = solid_angle > 0.0f ? 1.0f / (solid_angle > 0.0f ? solid_angle : 1.0f) : pdf;
  }
  return pdf;
}

PENUMBRA_NAMESPACE_END
#endif
