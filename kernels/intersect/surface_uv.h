// Texture coordinates and tangents, with Mitsuba 3's conventions.
#ifndef PENUMBRA_SURFACE_UV_H
#define PENUMBRA_SURFACE_UV_H
#include "kernels/intersect/instance.h"
#include "kernels/intersect/surface_fields.h"
#include "kernels/math/frame.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  float b0, b1, b2;
} Barycentric;

/// Barycentric coordinates of a point in the plane of p0, p1, p2.
FN Barycentric barycentric_among(vec3 p0, vec3 p1, vec3 p2, vec3 p) {
  const vec3 e1 = sub(p1, p0), e2 = sub(p2, p0), d = sub(p, p0);
  const vec3 n = cross3(e1, e2);
  const float n2 = dot3(n, n), inverse = n2 > 0.0f ? 1.0f / n2 : 0.0f;
  Barycentric b;
  b.b1 = dot3(cross3(d, e2), n) * inverse;
  b.b2 = dot3(cross3(e1, d), n) * inverse;
  b.b0 = (1.0f - b.b1) - b.b2;
  return b;
}
/// The same in the triangle's plane.
FN Barycentric barycentric_of(GLOBAL const Triangle* triangle, vec3 p) {
  return barycentric_among(load3(&triangle->p0), load3(&triangle->p1), load3(&triangle->p2), p);
}

typedef struct {
  float u, v;
} TexturePoint;

/// Texture coordinates of a triangle's vertices; record 0 if the scene has none.
FN GLOBAL const VertexUvs* uvs_of(const PRIVATE Scene* scene, int triangle) {
  return scene->vertex_uvs + (triangle < scene->header.tables.vertex_uvs.count ? triangle : 0);
}

FN TexturePoint triangle_uv(GLOBAL const VertexUvs* at, float b0, float b1, float b2) {
  TexturePoint t;
  t.u = (b0 * at->u0 + b1 * at->u1) + b2 * at->u2;
  t.v = (b0 * at->v0 + b1 * at->v1) + b2 * at->v2;
  return t;
}

/// The direction of dp/du of the triangle p0, p1, p2, or 0.
FN vec3 triangle_du(GLOBAL const VertexUvs* at, vec3 p0, vec3 p1, vec3 p2) {
  const vec3 e1 = sub(p1, p0), e2 = sub(p2, p0);
  const float u1 = at->u1 - at->u0, v1 = at->v1 - at->v0, u2 = at->u2 - at->u0, v2 = at->v2 - at->v0;
  const float determinant = u1 * v2 - v1 * u2;
  const vec3 along = scale(sub(scale(e1, v2), scale(e2, v1)), sign_of(determinant));
  return select3(determinant != 0.0f, along, make_vec3(0.0f, 0.0f, 0.0f));
}

/// The angle of (x, y) in turns, in [0, 1).
FN float turns_of(float x, float y) {
  const float turns = atan2_f(y, x) * (0.5f * INV_PI_F);
  return min_f(turns < 0.0f ? turns + 1.0f : turns, ONE_MINUS_EPSILON);
}

/// A vector in the frame of a quadric.
FN vec3 to_quadric_frame(Quadric q, vec3 v) {
  return make_vec3(dot3(v, q.x_axis), dot3(v, q.y_axis), dot3(v, q.normal));
}

/// The point of a sphere in the unit direction `outward` of its frame: longitude, and angle to the z axis.
FN TexturePoint sphere_uv(vec3 outward) {
  TexturePoint t;
  t.u = turns_of(outward.x, outward.y);
  t.v = min_f(atan2_f(SQRT(sqr(outward.x) + sqr(outward.y)), outward.z) * INV_PI_F, 1.0f);
  return t;
}

/// A point of a disk, relative to its centre in its frame: distance over radius, and angle.
FN TexturePoint disk_uv(vec3 from_center, float radius) {
  TexturePoint t;
  t.u = min_f(SQRT(sqr(from_center.x) + sqr(from_center.y)) / radius, 1.0f);
  t.v = turns_of(from_center.x, from_center.y);
  return t;
}

/// A point of a cylinder, relative to its first end in its frame: angle, and height over length.
FN TexturePoint cylinder_uv(vec3 from_center, float length) {
  TexturePoint t;
  t.u = turns_of(from_center.x, from_center.y);
  t.v = min_f(max_f(from_center.z / length, 0.0f), 1.0f);
  return t;
}

/// The quadric of a light that is a sphere, disk or cylinder.
FN Quadric quadric_of_light(const PRIVATE Scene* scene, int light) {
  GLOBAL const LightTriangles* parts =
      scene->light_triangles + (light < scene->header.tables.light_triangles.count ? light : 0);
  const int quadric = parts->quadric;
  return load_quadric(scene->quadrics + (quadric >= 0 ? quadric : 0));
}

/// Adds texture coordinates to the surface, and the tangent along dp/du, perpendicular to the unit normal.
FN Surface with_uv(Surface s, TexturePoint t, vec3 normal, vec3 du) {
  s.u = t.u;
  s.v = t.v;
  s.tangent = tangent_axis(normal, du);
  s.hand = 1.0f;
  s.smooth = s.shading;
  s.bumps = 0.0f;
  return s;
}

FN Surface with_triangle_uv(const PRIVATE Scene* scene, int index, PrimitivePoint r, Surface s) {
  GLOBAL const VertexUvs* at = uvs_of(scene, index);
  GLOBAL const Triangle* triangle = scene->triangles + index;
  return with_uv(s, triangle_uv(at, r.b0, r.b1, r.b2), r.normal,
                 triangle_du(at, load3(&triangle->p0), load3(&triangle->p1), load3(&triangle->p2)));
}

/// The surface of a triangle with the tangent and the hand of its vertices, if there are any. `r`: in the
/// scene. p0, p1, p2: the triangle, in its group if it has an instance `at`.
FN Surface with_vertex_tangents(const PRIVATE Scene* scene, int triangle, vec3 p0, vec3 p1, vec3 p2,
                                bool instanced, Instance at, PrimitivePoint r, Surface s) {
  GLOBAL const VertexTangents* corners = scene->vertex_tangents + triangle;
  const vec3 along = add(add(scale(load3(&corners->t0), r.b0), scale(load3(&corners->t1), r.b1)),
                         scale(load3(&corners->t2), r.b2));
  if (!(dot3(along, along) > 0.0f)) return s;
  const vec3 e1 = sub(p1, p0), e2 = sub(p2, p0), up = normalize_any(cross3(e1, e2));
  const vec3 tangent = add_scaled(add_scaled(scale(e1, along.x), along.y, e2), along.z, up);
  s.tangent = tangent_axis(s.shading, instanced ? from_group_vector(at, tangent) : tangent);
  const bool mirrors = instanced && dot3(at.x, cross3(at.y, at.z)) < 0.0f;
  s.hand = mirrors ? -corners->hand : corners->hand;
  return s;
}

/// Texture coordinates of a quadric's point, and the direction in which u grows.
typedef struct {
  TexturePoint at;
  vec3 du;
} QuadricUv;

FN QuadricUv quadric_uv(Quadric q, vec3 p) {
  const int kind = q.kind;
  const bool disk = kind == QUADRIC_DISK;
  const vec3 from_center = to_quadric_frame(q, sub(p, q.center));
  const TexturePoint on_sphere = sphere_uv(normalize3(from_center));
  const TexturePoint on_disk = disk_uv(from_center, q.radius);
  QuadricUv r;
  r.at.u = disk ? on_disk.u : on_sphere.u;
  r.at.v = disk ? on_disk.v : on_sphere.v;
  if (HAS(CYLINDERS)) {
    const TexturePoint on_cylinder = cylinder_uv(from_center, q.length);
    r.at.u = kind == QUADRIC_CYLINDER ? on_cylinder.u : r.at.u;
    r.at.v = kind == QUADRIC_CYLINDER ? on_cylinder.v : r.at.v;
  }
  // u grows away from the centre on a disk, with longitude on the others.
  const float x = disk ? from_center.x : -from_center.y, y = disk ? from_center.y : from_center.x;
  r.du = add_scaled(scale(q.x_axis, x), y, q.y_axis);
  return r;
}

FN Surface with_quadric_uv(const PRIVATE Scene* scene, int index, PrimitivePoint r, Surface s) {
  const QuadricUv uv = quadric_uv(load_quadric(scene->quadrics + index), r.p);
  return with_uv(s, uv.at, r.normal, uv.du);
}

/// For a primitive of the instance; `r` is in scene space.
FN Surface with_instance_uv(const PRIVATE Scene* scene, int primitive, Instance at, PrimitivePoint r,
                            Surface s) {
  const int quadric = primitive - scene->header.tables.triangles.count;
  const bool is_triangle = (primitive >= 0) & (quadric < 0);
  const int index = is_triangle ? primitive : 0;
  GLOBAL const VertexUvs* corners = uvs_of(scene, index);
  GLOBAL const Triangle* triangle = scene->triangles + index;
  TexturePoint t = triangle_uv(corners, r.b0, r.b1, r.b2);
  vec3 du = triangle_du(corners, load3(&triangle->p0), load3(&triangle->p1), load3(&triangle->p2));
  if (HAS(QUADRICS)) {
    const QuadricUv uv =
        quadric_uv(load_quadric(scene->quadrics + (quadric >= 0 ? quadric : 0)), to_group_point(at, r.p));
    t.u = quadric >= 0 ? uv.at.u : t.u;
    t.v = quadric >= 0 ? uv.at.v : t.v;
    du = select3(quadric >= 0, uv.du, du);
  }
  return with_uv(s, t, r.normal, from_group_vector(at, du));
}

PENUMBRA_NAMESPACE_END
#endif
