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

/// The triangles of light `light`.
FN GLOBAL const LightTriangles* triangles_of_light(const PRIVATE Scene* scene, int light) {
  return scene->light_triangles + (light < scene->header.tables.light_triangles.count ? light : 0);
}

/// Sets the point's texture coordinates on light `light`, which is one triangle with the corners of `flat`.
FN LightPoint with_corner_uv(const PRIVATE Scene* scene, int light, FlatLight flat, LightPoint at) {
  const int own = triangles_of_light(scene, light)->first;
  const Barycentric b = barycentric_among(flat.p0, flat.p1, flat.p2, at.p);
  const TexturePoint t = triangle_uv(uvs_of(scene, own >= 0 ? own : 0), b.b0, b.b1, b.b2);
  at.u = t.u;
  at.v = t.v;
  return at;
}

/// Sets the point's texture coordinates from the triangle of light `light` on which it lies.
FN LightPoint with_flat_uv(const PRIVATE Scene* scene, int light, LightPoint at) {
  GLOBAL const LightTriangles* parts = triangles_of_light(scene, light);
  const int first = parts->first >= 0 ? parts->first : 0, second = parts->second >= 0 ? parts->second : 0;
  const Barycentric b = barycentric_of(scene->triangles + first, at.p);
  const Barycentric c = barycentric_of(scene->triangles + second, at.p);
  const TexturePoint s = triangle_uv(uvs_of(scene, first), b.b0, b.b1, b.b2);
  const TexturePoint t = triangle_uv(uvs_of(scene, second), c.b0, c.b1, c.b2);
  const bool on_first = least_of(b) >= least_of(c);
  at.u = on_first ? s.u : t.u;
  at.v = on_first ? s.v : t.v;
  return at;
}

PENUMBRA_NAMESPACE_END
#endif
