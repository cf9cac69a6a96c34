// Sphere lights, sampled by the cone that they subtend, or by area.
#ifndef PENUMBRA_SPHERE_LIGHT_H
#define PENUMBRA_SPHERE_LIGHT_H
#include "kernels/intersect/surface_uv.h"
#include "kernels/light/kind_functions.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

/// 1 - cos of the half-angle of the cone that a sphere subtends at squared distance d2 > radius^2.
FN float cone_versine(float d2, float radius2) {
  const float sine2 = radius2 / d2;
  return sine2 / (1.0f + safe_sqrt(1.0f - sine2));
}

/// Not for a sphere that emits inwards: its inside is a receiver, and rounding puts points on either side of
/// it.
FN bool sphere_light_is_cone(Light light, float d2, float r2) {
  return (light.p2.y > 0.0f) & (d2 > r2) & (light.sampling != EMITTER_AREA);
}

LIGHT_EMITS_UNIFORMLY(sphere)

FN SampledPoint sample_sphere_point(const PRIVATE Scene* scene, int index, Light light, LightAxes axes,
                                    LightReceiver r, float u, float v, ulong strategies) {
  const vec3 center = light.p0;
  const float radius = light.p2.x, orientation = light.p2.y;
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const vec3 uniform = sample_uniform_sphere(u, v);
  const vec3 to_center = sub(center, r.p);
  const float d2 = dot3(to_center, to_center), r2 = sqr(radius);
  const bool cone = sphere_light_is_cone(light, d2, r2);
  // Samples a direction in the cone that the sphere subtends, and computes the angle at the sphere's centre.
  const float versine_max = cone_versine(cone ? d2 : 1.0f, cone ? r2 : 0.5f);
  const float versine = u * versine_max;
  const float sine2 = versine * (2.0f - versine);
  const float distance = SQRT(cone ? d2 : 1.0f);
  const float ratio2 = r2 / (cone ? d2 : 1.0f);
  const float half_chord = safe_sqrt(1.0f - sine2 / max_f(ratio2, 1e-30f));
  const float cosine_center = sine2 / SQRT(max_f(ratio2, 1e-30f)) + (1.0f - versine) * half_chord;
  // By the law of sines from the distance along the direction. The cosine would lose small angles, which look
  // wide to a receiver close to the sphere.
  const float product = radius * (distance * (1.0f - versine) + radius * half_chord);
  const float sine_center = SQRT(sine2) * (d2 - r2) / max_f(product, 1e-30f);
  const vec3 back = scale(to_center, -1.0f / (cone ? distance : 1.0f));
  const vec3 in_cone = from_frame(select3(cone, back, make_vec3(0.0f, 0.0f, 1.0f)), sine_center * cosine,
                                  sine_center * sine, cosine_center);
  const vec3 outward = select3(cone, in_cone, uniform);
  SampledPoint s;
  s.at = light_point(add_scaled(center, radius, outward), scale(outward, orientation));
  s.spread = dot3(abs3(s.at.normal), add(abs3(center), make_vec3(radius, radius, radius)));
  s.pdf = cone ? 1.0f / (2.0f * PI_F * versine_max) : 0.0f;
  if (BY(strategies, UV)) {
    const TexturePoint on = sphere_uv(to_light_axes(axes, outward));
    s.at.u = on.u;
    s.at.v = on.v;
  }
  return s;
}

SAMPLE_LIGHT_BY_POINT(sphere)

FN float sphere_light_pdf(const PRIVATE Scene* scene, Light light, FoundLight found, ulong strategies) {
  const vec3 to_center = sub(light.p0, found.from);
  const float d2 = dot3(to_center, to_center), r2 = sqr(light.p2.x);
  const bool cone = sphere_light_is_cone(light, d2, r2);
  const float versine = cone_versine(cone ? d2 : 1.0f, cone ? r2 : 0.5f);
  const float by_area = area_to_solid_angle(sqr(found.distance), found.cosine, light.area);
  return cone ? 1.0f / (2.0f * PI_F * versine) : by_area;
}

PENUMBRA_NAMESPACE_END
#endif
