// Lights: choosing one, a point on it, and the densities that multiple importance sampling compares.
#ifndef PENUMBRA_LIGHT_H
#define PENUMBRA_LIGHT_H
#include "kernels/block/path_state.h"
#include "kernels/intersect/surface.h"
#include "kernels/light/light_choice.h"
#include "kernels/light/light_sampling.h"
#include "kernels/light/spherical_rectangle.h"
#include "kernels/light/spherical_triangle.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

// A shadow ray ends this much before the light.
#define SHADOW_RAY_END (1.0f - 64.0f * HALF_EPSILON)
// Below this solid angle a triangle's area sampling is as good and rounds better.
#define SMALL_SOLID_ANGLE 3e-4f

typedef struct {
  vec3 origin;  ///< where the shadow ray starts
  vec3 toward;  ///< unit, its direction
  vec3 wi;  ///< unit, direction of the light: the same but for the offset of the origin, which counts near a
            ///< light
  float tmax;  ///< of the shadow ray; negative: no contribution possible
  float pdf;   ///< per solid angle, the choice of the light included; for a point light of the choice alone
  bool delta;  ///< a point light: no other strategy finds it
  bool of_polygon;  ///< a part of a polygon light, whose closed form is known
  vec3 radiance;    ///< arriving along wi, the inverse square law of a point light included
} LightSample;

/// Density per solid angle of a point at distance^2 `d2`, seen under `cosine` at the light, chosen uniformly
/// by area.
FN float area_to_solid_angle(float d2, float cosine, float area) {
  return cosine > 0.0f ? d2 / (cosine * area) : 0.0f;
}

#if HAS(QUADRICS)
/// 1 - cos of the half-angle of the cone about a sphere at distance^2 d2 > radius^2.
FN float cone_versine(float d2, float radius2) {
  const float sine2 = radius2 / d2;
  return sine2 / (1.0f + safe_sqrt(1.0f - sine2));
}
#endif

#if HAS(SOLID_ANGLE)
/// A triangle or rectangle light as a direction of the shading point sees it.
typedef struct {
  SphericalTriangle triangle;
  SphericalRectangle rectangle;
  bool is_rectangle;
  float solid_angle;  ///< 0: not sampled by it, since the light is of another kind, or too small
} SphericalLight;

/// A kernel may be compiled for more than its scene, and its scene's lights may differ.
FN SphericalLight spherical_light(GLOBAL const Light* light, vec3 from) {
  const vec3 p0 = sub(load3(&light->p0), from), p1 = sub(load3(&light->p1), from);
  const vec3 p2 = sub(load3(&light->p2), from);
  SphericalLight s;
  s.triangle = spherical_triangle(p0, p1, p2);
  s.rectangle = spherical_rectangle(p0, p1, p2);
  s.is_rectangle = light->kind == LIGHT_RECTANGLE;
  const float least = s.is_rectangle ? SMALL_RECTANGLE_SOLID_ANGLE : SMALL_SOLID_ANGLE;
  const float solid_angle = s.is_rectangle ? s.rectangle.solid_angle : s.triangle.solid_angle;
  const bool wanted =
      (s.is_rectangle | (light->kind == LIGHT_TRIANGLE)) & (light->sampling == EMITTER_SOLID_ANGLE);
  s.solid_angle = (wanted & (solid_angle > least)) ? solid_angle : 0.0f;
  return s;
}

FN vec3 sample_spherical_light(SphericalLight s, float u, float v) {
  return select3(s.is_rectangle, sample_spherical_rectangle(s.rectangle, u, v),
                 sample_spherical_triangle(s.triangle, u, v));
}
#endif

/// Density with which sample_light by itself chooses the direction from `from` to a point of the light
/// that is `distance` away and whose front is seen under `cosine`.
FN float light_pdf(const PRIVATE Scene* scene, int index, vec3 from, float distance, float cosine) {
  GLOBAL const Light* light = scene->lights + index;
  float pdf = area_to_solid_angle(sqr(distance), cosine, light->area);
#if HAS(SOLID_ANGLE)
  {
    const float solid_angle = spherical_light(light, from).solid_angle;
    pdf = solid_angle > 0.0f ? 1.0f / (solid_angle > 0.0f ? solid_angle : 1.0f) : pdf;
  }
#endif
#if HAS(QUADRICS)
  {
    const vec3 to_center = sub(load3(&light->p0), from);
    const float d2 = dot3(to_center, to_center), r2 = sqr(light->p2.x);
    const bool cone =
        (light->kind == LIGHT_SPHERE) & (light->p2.y > 0.0f) & (d2 > r2) & (light->sampling != EMITTER_AREA);
    const float versine = cone_versine(cone ? d2 : 1.0f, cone ? r2 : 0.5f);
    pdf = cone ? 1.0f / (2.0f * PI_F * versine) : pdf;
  }
#endif
#if HAS(ENVIRONMENT)
  pdf = light->kind == LIGHT_ENVIRONMENT ? 0.25f * INV_PI_F : pdf;
#endif
  return pdf * light->pmf;
}

/// Chooses a light and a point on it by (u, v), or as `sampling` says, for lighting the surface; `fine`: see
/// choose_light.
FN LightSample sample_light(const PRIVATE Scene* scene, Surface s, float number, float v, float fine,
                            LightSampling sampling) {
  const ChosenLight by_power = choose_light(scene, number, fine);
#if HAS(POLYGONS)
  const bool is_chosen = sampling.light >= 0.0f;
  const int index = is_chosen ? (int)sampling.light : by_power.light;
  const float u = is_chosen ? number : by_power.u;
  GLOBAL const Light* light = scene->lights + index;
  const float light_pmf = light->pmf;
  const float pmf = is_chosen ? sampling.pmf : light_pmf;
#else
  const int index = by_power.light;
  GLOBAL const Light* light = scene->lights + index;
  const float u = by_power.u;
  const float pmf = light->pmf;
#endif
  LightSample sample;
  const float root = SQRT(u);
  float b0 = 1.0f - root, b1 = v * root, b2 = (1.0f - b0) - b1;
#if HAS(SOLID_ANGLE)
  const bool rectangle = light->kind == LIGHT_RECTANGLE;
  b0 = rectangle ? (1.0f - u) - v : b0;
  b1 = rectangle ? u : b1;
  b2 = rectangle ? v : b2;
#endif
  const vec3 p0 = load3(&light->p0), p1 = load3(&light->p1), p2 = load3(&light->p2);
  const vec3 q0 = scale(p0, b0), q1 = scale(p1, b1), q2 = scale(p2, b2);
  vec3 at = add(add(q0, q1), q2);
  vec3 normal = normalize3(cross3(sub(p1, p0), sub(p2, p0)));
  vec3 extent = add(add(abs3(q0), abs3(q1)), abs3(q2));
  // Where a ray meets a triangle is known to a few roundings of its vertices seen from the ray's origin: a
  // point close to a large light would lie in its shadow otherwise.
  float reach = max_f(max_component(abs3(sub(p0, s.p))),
                      max_f(max_component(abs3(sub(p1, s.p))), max_component(abs3(sub(p2, s.p)))));
  float direct_pdf = 0.0f;  // per solid angle, where the sampling is by direction
#if HAS(SOLID_ANGLE)
  {
    const SphericalLight spherical = spherical_light(light, s.p);
    const bool use = spherical.solid_angle > 0.0f;
    const vec3 w = sample_spherical_light(spherical, u, v);
    // The point of the light's plane in that direction.
    const float along = dot3(w, normal);
    const float distance = dot3(sub(p0, s.p), normal) / (along != 0.0f ? along : 1.0f);
    at = select3(use, add_scaled(s.p, distance, w), at);
    direct_pdf = use ? 1.0f / (use ? spherical.solid_angle : 1.0f) : 0.0f;
  }
#endif
#if HAS(PROJECTED)
  const bool is_directed = sampling.scale > 0.0f;
  {
    const float along = dot3(sampling.wi, normal);
    const float distance = dot3(sub(p0, s.p), normal) / (along != 0.0f ? along : 1.0f);
    at = select3(is_directed, add_scaled(s.p, distance, sampling.wi), at);
  }
#endif
#if HAS(QUADRICS)
  {
    const bool sphere = light->kind == LIGHT_SPHERE, disk = light->kind == LIGHT_DISK;
    const float radius = p2.x, orientation = p2.y;
    float sine, cosine;
    sincos_2pi(v, &sine, &cosine);
    const vec3 on_disk = from_frame(p1, radius * root * cosine, radius * root * sine, 0.0f);
    const vec3 uniform = sample_uniform_sphere(u, v);
    const vec3 to_center = sub(p0, s.p);
    const float d2 = dot3(to_center, to_center), r2 = sqr(radius);
    // A sphere that emits inwards is its own receiver: rounding puts points on it to either side of its
    // surface.
    const bool cone = sphere & (orientation > 0.0f) & (d2 > r2) & (light->sampling != EMITTER_AREA);
    // A direction in the cone that the sphere subtends, and from it the angle at the sphere's centre.
    const float versine_max = cone_versine(cone ? d2 : 1.0f, cone ? r2 : 0.5f);
    const float versine = u * versine_max;
    const float sine2 = versine * (2.0f - versine);
    const float distance = SQRT(cone ? d2 : 1.0f);
    const float ratio2 = r2 / (cone ? d2 : 1.0f);
    const float half_chord = safe_sqrt(1.0f - sine2 / max_f(ratio2, 1e-30f));
    const float cosine_center = sine2 / SQRT(max_f(ratio2, 1e-30f)) + (1.0f - versine) * half_chord;
    // By the law of sines from the distance along the direction: the cosine would lose small angles, which
    // are wide ones for a receiver close to the sphere.
    const float product = radius * (distance * (1.0f - versine) + radius * half_chord);
    const float sine_center = SQRT(sine2) * (d2 - r2) / max_f(product, 1e-30f);
    const vec3 toward = scale(to_center, -1.0f / (cone ? distance : 1.0f));
    const vec3 in_cone = from_frame(select3(cone, toward, make_vec3(0.0f, 0.0f, 1.0f)), sine_center * cosine,
                                    sine_center * sine, cosine_center);
    const vec3 outward = select3(cone, in_cone, uniform);
    at = select3(sphere, add_scaled(p0, radius, outward), select3(disk, add(p0, on_disk), at));
    normal = select3(sphere, scale(outward, orientation), select3(disk, p1, normal));
    extent = select3(sphere | disk, add(abs3(p0), make_vec3(radius, radius, radius)), extent);
    reach = (sphere | disk) ? 0.0f : reach;
    direct_pdf = cone ? 1.0f / (2.0f * PI_F * versine_max) : direct_pdf;
  }
#endif
  // At most half the way to the point's side: one that is closer to the light than its position's error would
  // look the wrong way.
  const vec3 back = sub(s.p, at);
  const float error =
      min_f(POSITION_ERROR * max_f(dot3(abs3(normal), extent), reach), 0.5f * FABS(dot3(back, normal)));
  vec3 target = leave_surface(at, normal, error, back);
#if HAS(POINT_LIGHTS)
  const bool point = light->kind == LIGHT_POINT;
  target = select3(point, p0, target);
#endif
  sample.origin = leave_surface(s.p, s.geometric, s.error, sub(target, s.p));
  const vec3 way = sub(target, sample.origin);
  const float d2 = dot3(way, way);
  const float distance = SQRT(d2);
  sample.toward = sample.wi = scale(way, 1.0f / max_f(distance, 1e-30f));
  sample.tmax = distance * SHADOW_RAY_END;
  const float cosine_front = -dot3(sample.wi, normal);
  const float cosine = light->two_sided ? FABS(cosine_front) : cosine_front;
  sample.pdf = direct_pdf > 0.0f ? direct_pdf : area_to_solid_angle(d2, cosine, light->area);
#if HAS(PROJECTED)
  // Of the direction itself: seen from the shadow ray's origin it may be below the light's plane.
  sample.wi = select3(is_directed, sampling.wi, sample.wi);
  sample.pdf = is_directed ? max_f(dot3(s.shading, sample.wi), 0.0f) * sampling.scale : sample.pdf;
#endif
  sample.delta = false;
  sample.of_polygon = light->polygon >= 0;
  sample.radiance = load3(&light->radiance);
  bool possible = (cosine > 0.0f) & (distance > 0.0f) & !is_own_light(scene, s, index);
#if HAS(POINT_LIGHTS)
  sample.delta = point;
  sample.pdf = point ? 1.0f : sample.pdf;
  sample.radiance = scale(sample.radiance, point ? 1.0f / d2 : 1.0f);
  possible = possible | (point & (distance > 0.0f));
#endif
#if HAS(ENVIRONMENT)
  {
    const bool environment = light->kind == LIGHT_ENVIRONMENT;
    const vec3 direction = sample_uniform_sphere(u, v);
    sample.origin = select3(environment, leave_surface(s.p, s.geometric, s.error, direction), sample.origin);
    sample.wi = select3(environment, direction, sample.wi);
    sample.toward = select3(environment, direction, sample.toward);
    sample.tmax = environment ? NO_LIMIT : sample.tmax;
    sample.pdf = environment ? 0.25f * INV_PI_F : sample.pdf;
    possible = possible | environment;
  }
#endif
  sample.pdf *= pmf;
  possible = possible & (sample.pdf > 0.0f);
  sample.tmax = possible ? sample.tmax : -1.0f;
  return sample;
}

/// Asks for the shadow ray of lane i's light sample, from the surface and primitive that it starts on;
/// `arriving` is what it adds if nothing is in the way.
FN void ask_for_shadow_ray(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                           int capacity, int i, Surface s, LightSample light, vec3 arriving, bool lit,
                           int primitive) {
  const bool beneath = is_beneath(s, light.wi) & (scene->header.integrator.trace_shadows != 0);
  const bool controlled = (scene->header.integrator.estimator != ESTIMATOR_SAMPLES) & light.of_polygon;
  STORE3(f, capacity, SHADOW_ORIGIN_X, i, light.origin);
  STORE3(f, capacity, SHADOW_DIRECTION_X, i, light.toward);
  STORE3(f, capacity, SHADOW_RADIANCE_X, i, arriving);
  f[SHADOW_TMAX * capacity + i] = (lit & (controlled | !beneath)) ? light.tmax : -1.0f;
  ints[SHADOW_SKIP * capacity + i] = primitive;
#if HAS(POLYGONS)
  ints[SHADOW_CONTROLLED * capacity + i] =
      controlled ? (beneath ? CONTROLLED_BENEATH : CONTROLLED_SEEN) : CONTROLLED_NOT;
#endif
}

/// What the light that a ray found adds to it.
FN vec3 emitted_radiance(const PRIVATE Scene* scene, Surface s) {
  const int index = light_found(scene, s);
  return select3(index >= 0, load3(&scene->lights[index >= 0 ? index : 0].radiance),
                 make_vec3(0.0f, 0.0f, 0.0f));
}

/// Radiance that a ray brings when it ends on this surface, or leaves the scene; `pdf` is sample_light's
/// density for the ray's direction from its origin (0 where no light is there).
typedef struct {
  vec3 radiance;
  float pdf;
  bool of_polygon;  ///< see LightSample
} Emission;

FN Emission emission_at(const PRIVATE Scene* scene, Surface s, vec3 from, LightSampling sampling) {
  Emission e;
  const int index = light_found(scene, s), safe = index >= 0 ? index : 0;
  e.radiance = emitted_radiance(scene, s);
  const int polygon = scene->lights[safe].polygon;
  e.of_polygon = (index >= 0) & (polygon >= 0);
  e.pdf = light_pdf(scene, safe, from, s.distance, dot3(s.geometric, s.wo));
#if HAS(PROJECTED)
  const float pmf = scene->lights[safe].pmf;
  e.pdf = sampling.found_pdf >= 0.0f ? sampling.found_pdf * pmf : e.pdf;
#endif
  e.pdf = index >= 0 ? e.pdf : 0.0f;
  return e;
}

PENUMBRA_NAMESPACE_END
#endif
