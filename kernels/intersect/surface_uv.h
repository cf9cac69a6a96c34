// Texture coordinates and tangents, as Mitsuba 3 has them. Spheres and disks are not rotated here: readers
// keep a sphere's centre and radius and a disk's normal of their transform, so that a sphere's poles lie
// along the z axis of the scene, and a disk's angle starts along the first axis of from_frame, whatever the
// file says.
#ifndef PENUMBRA_SURFACE_UV_H
#define PENUMBRA_SURFACE_UV_H
#include "kernels/intersect/surface_fields.h"
#include "kernels/math/frame.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

#if HAS(UV)
typedef struct {
  float u, v;
} TexturePoint;

/// Of a triangle's vertices; record 0 where the scene has none.
FN GLOBAL const VertexUvs* uvs_of(const PRIVATE Scene* scene, int triangle) {
  return scene->vertex_uvs + (triangle < scene->header.tables.vertex_uvs.count ? triangle : 0);
}

FN TexturePoint triangle_uv(GLOBAL const VertexUvs* at, float b0, float b1, float b2) {
  TexturePoint t;
  t.u = (b0 * at->u0 + b1 * at->u1) + b2 * at->u2;
  t.v = (b0 * at->v0 + b1 * at->v1) + b2 * at->v2;
  return t;
}

/// dp/du of a triangle about its unit normal.
FN vec3 triangle_tangent(GLOBAL const VertexUvs* at, GLOBAL const Triangle* triangle, vec3 normal) {
  const vec3 p0 = load3(&triangle->p0);
  const vec3 e1 = sub(load3(&triangle->p1), p0), e2 = sub(load3(&triangle->p2), p0);
  const float u1 = at->u1 - at->u0, v1 = at->v1 - at->v0, u2 = at->u2 - at->u0, v2 = at->v2 - at->v0;
  const float determinant = u1 * v2 - v1 * u2;
  const vec3 along = scale(sub(scale(e1, v2), scale(e2, v1)), sign_of(determinant));
  const bool some = (at->given != 0) & (determinant != 0.0f);
  return tangent_axis(normal, select3(some, along, make_vec3(0.0f, 0.0f, 0.0f)));
}

/// Of the angle of (x, y), in [0, 1).
FN float turns_of(float x, float y) {
  const float turns = atan2_f(y, x) * (0.5f * INV_PI_F);
  return min_f(turns < 0.0f ? turns + 1.0f : turns, ONE_MINUS_EPSILON);
}

/// Of the point of a sphere in that unit direction from its centre: longitude, and angle from the z axis.
FN TexturePoint sphere_uv(vec3 outward) {
  TexturePoint t;
  t.u = turns_of(outward.x, outward.y);
  t.v = min_f(atan2_f(SQRT(sqr(outward.x) + sqr(outward.y)), outward.z) * INV_PI_F, 1.0f);
  return t;
}

/// Of a disk's point, as seen from its centre: distance over the radius, and angle.
FN TexturePoint disk_uv(vec3 from_center, vec3 normal, float radius) {
  const vec3 flat = to_frame(normal, from_center);
  TexturePoint t;
  t.u = min_f(SQRT(sqr(flat.x) + sqr(flat.y)) / radius, 1.0f);
  t.v = turns_of(flat.x, flat.y);
  return t;
}

/// The surface with what only scenes with FEATURE_UV know of it.
FN Surface with_triangle_uv(const PRIVATE Scene* scene, int triangle, PrimitivePoint r, Surface s) {
  GLOBAL const VertexUvs* at = uvs_of(scene, triangle);
  const TexturePoint t = triangle_uv(at, r.b0, r.b1, r.b2);
  s.u = t.u;
  s.v = t.v;
  s.tangent = triangle_tangent(at, scene->triangles + triangle, r.normal);
  return s;
}

  #if HAS(QUADRICS)
FN Surface with_quadric_uv(const PRIVATE Scene* scene, int index, PrimitivePoint r, Surface s) {
  GLOBAL const Quadric* q = scene->quadrics + index;
  const bool sphere = q->kind == QUADRIC_SPHERE;
  const vec3 from_center = sub(r.p, load3(&q->center));
  const TexturePoint on_sphere = sphere_uv(normalize3(from_center));
  const TexturePoint on_disk = disk_uv(from_center, load3(&q->normal), q->radius);
  s.u = sphere ? on_sphere.u : on_disk.u;
  s.v = sphere ? on_sphere.v : on_disk.v;
  const vec3 east = make_vec3(-from_center.y, from_center.x, 0.0f);
  s.tangent = tangent_axis(r.normal, select3(sphere, east, from_center));
  return s;
}
  #endif
#endif

PENUMBRA_NAMESPACE_END
#endif
