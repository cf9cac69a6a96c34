// Triangle lights, sampled by area, by solid angle, or in the direction that the light sampling stage sampled
// by projected solid angle.
#ifndef PENUMBRA_TRIANGLE_LIGHT_H
#define PENUMBRA_TRIANGLE_LIGHT_H
#include "kernels/light/flat_light.h"
#include "kernels/light/kind_functions.h"
#include "kernels/light/spherical_triangle.h"

PENUMBRA_NAMESPACE_BEGIN

// Below this solid angle, area sampling of a triangle is as good and rounds better.
#define SMALL_SOLID_ANGLE 3e-4f

/// The triangle as seen from `from`. The solid angle is 0 if the light is not sampled by it.
FN SphericalTriangle seen_triangle(Light light, vec3 from) {
  const vec3 p0 = sub(light.p0, from), p1 = sub(light.p1, from);
  SphericalTriangle t = spherical_triangle(p0, p1, sub(light.p2, from));
  const bool wanted = (light.sampling == EMITTER_SOLID_ANGLE) & (t.solid_angle > SMALL_SOLID_ANGLE);
  t.solid_angle = wanted ? t.solid_angle : 0.0f;
  return t;
}

LIGHT_EMITS_UNIFORMLY(triangle)

FN SampledPoint sample_triangle_point(const PRIVATE Scene* scene, int index, Light light, LightReceiver r,
                                      float u, float v, LightSampling sampling, ulong strategies) {
  const FlatLight flat = flat_light(light);
  const float root = SQRT(u), b0 = 1.0f - root, b1 = v * root;
  SampledPoint s = flat_light_point(flat, r.p, b0, b1, (1.0f - b0) - b1);
  if (BY(strategies, SOLID_ANGLE)) {
    const SphericalTriangle seen = seen_triangle(light, r.p);
    const bool use = seen.solid_angle > 0.0f;
    s.at.p = select3(use, flat_light_seen(flat, r.p, sample_spherical_triangle(seen, u, v)), s.at.p);
    s.pdf = use ? 1.0f / (use ? seen.solid_angle : 1.0f) : 0.0f;
  }
  if (BY(strategies, PROJECTED))
    s.at.p = select3(sampling.scale > 0.0f, flat_light_seen(flat, r.p, sampling.wi), s.at.p);
  if (BY(strategies, UV)) s.at = with_corner_uv(scene, index, flat, s.at);
  return s;
}

FN LightSample sample_triangle_light(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                     LightReceiver r, float u, float v, LightSampling sampling,
                                     ulong strategies) {
  const SampledPoint point = sample_triangle_point(scene, index, light, r, u, v, sampling, strategies);
  LightSample s = toward_light(light, r, point);
  if (BY(strategies, PROJECTED)) {
    const bool is_directed = sampling.scale > 0.0f;
    // The sampled direction itself is used: seen from the shadow ray's origin, it may be below the light's
    // plane.
    s.wi = select3(is_directed, sampling.wi, s.wi);
    s.pdf = is_directed ? max_f(dot3(r.shading, s.wi), 0.0f) * sampling.scale : s.pdf;
  }
  s.radiance = triangle_light_radiance(scene, light, point.at, s.wi);
  return s;
}

FN float triangle_light_pdf(const PRIVATE Scene* scene, Light light, FoundLight found, ulong strategies) {
  float pdf = area_to_solid_angle(sqr(found.distance), found.cosine, light.area);
  if (BY(strategies, SOLID_ANGLE)) {
    const float solid_angle = seen_triangle(light, found.from).solid_angle;
    pdf = solid_angle > 0.0f ? 1.0f / (solid_angle > 0.0f ? solid_angle : 1.0f) : pdf;
  }
  if (BY(strategies, PROJECTED)) pdf = found.projected_pdf >= 0.0f ? found.projected_pdf : pdf;
  return pdf;
}

PENUMBRA_NAMESPACE_END
#endif
