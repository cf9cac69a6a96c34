// What triangle and rectangle lights share: points in a plane.
#ifndef PENUMBRA_FLAT_LIGHT_H
#define PENUMBRA_FLAT_LIGHT_H
#include "kernels/intersect/surface_uv.h"
#include "kernels/light/light_sample.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 p0, p1, p2;
  vec3 normal;
} FlatLight;

FN FlatLight flat_light(Light light) {
  FlatLight f;
  f.p0 = light.p0;
  f.p1 = light.p1;
  f.p2 = light.p2;
  f.normal = normalize3(cross3(sub(f.p1, f.p0), sub(f.p2, f.p0)));
  return f;
}

/// The point b0 p0 + b1 p1 + b2 p2, with the pdf of uniform sampling by area.
FN SampledPoint flat_light_point(FlatLight f, vec3 from, float b0, float b1, float b2) {
  SampledPoint s;
  const vec3 q0 = scale(f.p0, b0), q1 = scale(f.p1, b1), q2 = scale(f.p2, b2);
  s.at = light_point(add(add(q0, q1), q2), f.normal);
  s.pdf = 0.0f;
  const vec3 extent = add(add(abs3(q0), abs3(q1)), abs3(q2));
  // The position where a ray meets a triangle is known to a few roundings of the vertices relative to the
  // ray's origin. Without this bound, a point close to a large light would be shadowed by the light itself.
  const float reach =
      max_f(max_component(abs3(sub(f.p0, from))),
            max_f(max_component(abs3(sub(f.p1, from))), max_component(abs3(sub(f.p2, from)))));
  s.spread = max_f(dot3(abs3(f.normal), extent), reach);
  return s;
}

/// The point of the light's plane in direction w from `from`.
FN vec3 flat_light_seen(FlatLight f, vec3 from, vec3 w) {
  const float along = dot3(w, f.normal);
  const float distance = dot3(sub(f.p0, from), f.normal) / (along != 0.0f ? along : 1.0f);
  return add_scaled(from, distance, w);
}

FN float least_of(Barycentric b) { return min_f(b.b0, min_f(b.b1, b.b2)); }

/// Barycentric coordinates in a triangle of light `light`, whose shape at the time is `flat`. A light that
/// moves is one triangle.
FN Barycentric barycentric_on_light(const PRIVATE Scene* scene, int light, FlatLight flat, int triangle,
                                    vec3 p, ulong strategies) {
  GLOBAL const Triangle* t = scene->triangles + triangle;
  vec3 p0 = load3(&t->p0), p1 = load3(&t->p1), p2 = load3(&t->p2);
  if (BY(strategies, MOTION)) {
    const bool moves = light_moves(scene, light);
    p0 = select3(moves, flat.p0, p0);
    p1 = select3(moves, flat.p1, p1);
    p2 = select3(moves, flat.p2, p2);
  }
  return barycentric_among(p0, p1, p2, p);
}

/// Sets the point's texture coordinates from the triangle of light `light` on which it lies.
FN LightPoint with_flat_uv(const PRIVATE Scene* scene, int light, FlatLight flat, LightPoint at,
                           ulong strategies) {
  GLOBAL const LightTriangles* parts =
      scene->light_triangles + (light < scene->header.tables.light_triangles.count ? light : 0);
  const int first = parts->first >= 0 ? parts->first : 0, second = parts->second >= 0 ? parts->second : 0;
  const Barycentric b = barycentric_on_light(scene, light, flat, first, at.p, strategies);
  const Barycentric c = barycentric_on_light(scene, light, flat, second, at.p, strategies);
  const TexturePoint s = triangle_uv(uvs_of(scene, first), b.b0, b.b1, b.b2);
  const TexturePoint t = triangle_uv(uvs_of(scene, second), c.b0, c.b1, c.b2);
  const bool on_first = least_of(b) >= least_of(c);
  at.u = on_first ? s.u : t.u;
  at.v = on_first ? s.v : t.v;
  return at;
}

PENUMBRA_NAMESPACE_END
#endif
