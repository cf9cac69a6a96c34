// The surface where a ray meets a primitive. The intersector only says which primitive it is. The position is
// recomputed from the primitive, so that all intersectors agree and positions are accurate far along a ray.
#ifndef PENUMBRA_SURFACE_H
#define PENUMBRA_SURFACE_H
#include "kernels/intersect/curve_surface.h"
#include "kernels/intersect/instance.h"
#include "kernels/intersect/quadric.h"
#include "kernels/intersect/surface_uv.h"
#include "kernels/intersect/triangle.h"

PENUMBRA_NAMESPACE_BEGIN

/// The index of a triangle; record 0 is a placeholder for primitives that are no triangle.
FN int triangle_of(const PRIVATE Scene* scene, int primitive) {
  const bool is_triangle = (primitive >= 0) & (primitive < scene->header.tables.triangles.count);
  return is_triangle ? primitive : 0;
}

/// The materials of a primitive's sides. For no primitive (-1) they are arbitrary.
typedef struct {
  int front, back;
} SideMaterials;

FN SideMaterials side_materials(const PRIVATE Scene* scene, int primitive) {
  GLOBAL const Triangle* triangle = scene->triangles + triangle_of(scene, primitive);
  const int front = triangle->front, back = triangle->back;
  SideMaterials sides;
  sides.front = front;
  sides.back = back;
  if (HAS(QUADRICS)) {
    const int index = primitive - scene->header.tables.triangles.count;
    GLOBAL const Quadric* quadric = scene->quadrics + (index >= 0 ? index : 0);
    const int quadric_front = quadric->front, quadric_back = quadric->back;
    sides.front = index >= 0 ? quadric_front : front;
    sides.back = index >= 0 ? quadric_back : back;
  }
  return sides;
}

/// Where the ray from `o` along `d` meets the plane of p0, p1, p2. The caller sets materials and light.
FN PrimitivePoint point_in_triangle(vec3 p0, vec3 p1, vec3 p2, vec3 o, vec3 d) {
  const Shear shear = make_shear(d);
  const TriangleHit h = intersect_sheared(shear_point(shear, sub(p0, o)), shear_point(shear, sub(p1, o)),
                                          shear_point(shear, sub(p2, o)));
  const float inverse = h.det != 0.0f ? 1.0f / h.det : 0.0f;
  PrimitivePoint r;
  r.b0 = h.u * inverse;
  r.b1 = h.v * inverse;
  r.b2 = h.w * inverse;
  const vec3 q0 = scale(p0, r.b0), q1 = scale(p1, r.b1), q2 = scale(p2, r.b2);
  r.p = add(add(q0, q1), q2);
  r.extent = add(add(abs3(q0), abs3(q1)), abs3(q2));
  r.normal = r.shading = normalize3(cross3(sub(p1, p0), sub(p2, p0)));
  r.distance = h.t;
  return r;
}

FN PrimitivePoint of_triangle(GLOBAL const Triangle* triangle, PrimitivePoint r) {
  r.front = triangle->front;
  r.back = triangle->back;
  r.light = triangle->light;
  return r;
}

FN PrimitivePoint triangle_point(const PRIVATE Scene* scene, int index, vec3 o, vec3 d) {
  GLOBAL const Triangle* triangle = scene->triangles + index;
  return of_triangle(
      triangle, point_in_triangle(load3(&triangle->p0), load3(&triangle->p1), load3(&triangle->p2), o, d));
}

/// The interpolated normal at the point, if the triangle is smooth, else the flat normal.
FN vec3 blended_normal(vec3 n0, vec3 n1, vec3 n2, bool smooth, PrimitivePoint r) {
  vec3 blend = add(add(scale(n0, r.b0), scale(n1, r.b1)), scale(n2, r.b2));
  const float length2 = dot3(blend, blend);
  blend = scale(blend, 1.0f / SQRT(max_f(length2, 1e-30f)));
  return select3(smooth & (length2 > 1e-12f), blend, r.normal);
}

FN vec3 interpolated_normal(const PRIVATE Scene* scene, int index, PrimitivePoint r) {
  const int at = scene->triangles[index].normals;
  GLOBAL const VertexNormals* n = scene->normals + (at >= 0 ? at : 0);
  return blended_normal(load3(&n->n0), load3(&n->n1), load3(&n->n2), at >= 0, r);
}

/// Whether a primitive is a quadric; `quadric` is its index minus the number of triangles.
FN bool is_quadric(const PRIVATE Scene* scene, int quadric) { return quadric >= 0; }

FN bool is_cylinder(const PRIVATE Scene* scene, int quadric) {
  const int kind = scene->quadrics[quadric >= 0 ? quadric : 0].kind;
  return (quadric >= 0) & (kind == QUADRIC_CYLINDER);
}

/// Where the ray from `o` along `d` meets the cylinder.
FN PrimitivePoint point_on_cylinder(Quadric q, vec3 o, vec3 d) {
  const vec3 center = q.center, axis = q.normal;
  const float radius = q.radius, length = q.length;
  PrimitivePoint r;
  r.b0 = r.b1 = r.b2 = 0.0f;
  r.distance = intersect_cylinder(o, d, center, axis, radius, length);
  const vec3 from = sub(add_scaled(o, r.distance, d), center);
  const float height = dot3(from, axis);
  const vec3 across = add_scaled(from, -height, axis);
  const vec3 outward = scale(across, 1.0f / SQRT(max_f(dot3(across, across), 1e-37f)));
  // Moves the point radially onto the surface.
  r.p = add_scaled(add_scaled(center, height, axis), radius, outward);
  r.extent = add(abs3(center), make_vec3(radius + length, radius + length, radius + length));
  r.normal = r.shading = scale(outward, q.orientation);
  r.front = q.front;
  r.back = q.back;
  r.light = q.light;
  return r;
}

/// Where the ray from `o` along `d` meets the sphere or disk.
FN PrimitivePoint point_on_sphere_or_disk(Quadric q, vec3 o, vec3 d) {
  const bool sphere = q.kind == QUADRIC_SPHERE;
  const vec3 center = q.center, disk_normal = q.normal;
  const float radius = q.radius;
  const float t_sphere = intersect_sphere(o, d, center, radius);
  const float t_disk = intersect_disk(o, d, center, disk_normal, radius);
  PrimitivePoint r;
  r.b0 = r.b1 = r.b2 = 0.0f;
  r.distance = sphere ? t_sphere : t_disk;
  const vec3 at = add_scaled(o, r.distance, d);
  const vec3 outward = normalize3(sub(at, center));
  // Moves the point onto the surface: radially for a sphere, along the normal for a disk.
  const vec3 on_sphere = add_scaled(center, radius, outward);
  const vec3 on_disk = add_scaled(at, -dot3(sub(at, center), disk_normal), disk_normal);
  r.p = select3(sphere, on_sphere, on_disk);
  r.extent = add(abs3(center), make_vec3(radius, radius, radius));
  r.normal = r.shading = select3(sphere, scale(outward, q.orientation), disk_normal);
  r.front = q.front;
  r.back = q.back;
  r.light = q.light;
  return r;
}

/// Where the ray from `o` along `d` meets the quadric.
FN PrimitivePoint point_on_quadric(Quadric q, vec3 o, vec3 d) {
  PrimitivePoint r = point_on_sphere_or_disk(q, o, d);
  if (HAS(CYLINDERS)) r = select_primitive_point(q.kind == QUADRIC_CYLINDER, point_on_cylinder(q, o, d), r);
  return r;
}

/// A point of a group, in scene space.
FN PrimitivePoint placed_point(Instance at, PrimitivePoint r) {
  r.p = from_group_point(at, r.p);
  r.extent = from_group_extent(at, r.extent, r.p);
  r.normal = from_group_normal(at, r.normal);
  r.shading = from_group_normal(at, r.shading);
  return r;
}

/// Where the ray from `o` along `d` meets the instance's primitive; the result is in scene space.
FN PrimitivePoint instance_point(const PRIVATE Scene* scene, int primitive, Instance at, vec3 o, vec3 d) {
  const GroupRay ray = group_ray(at, o, d);
  const int triangle = triangle_of(scene, primitive);
  PrimitivePoint r = triangle_point(scene, triangle, ray.o, ray.d);
  if (HAS(SHADING_NORMALS)) r.shading = interpolated_normal(scene, triangle, r);
  if (HAS(QUADRICS)) {
    const int quadric = primitive - scene->header.tables.triangles.count;
    const UnitDirection unit = unit_direction(ray.d);
    PrimitivePoint q =
        point_on_quadric(load_quadric(scene->quadrics + (quadric >= 0 ? quadric : 0)), ray.o, unit.d);
    q.distance /= unit.length;
    r = select_primitive_point(quadric >= 0, q, r);
  }
  return placed_point(at, r);
}

/// Where the ray from `o` along `d` meets the curve of the instance, likewise.
FN PrimitivePoint instance_curve_point(const PRIVATE Scene* scene, int quadric, Instance at, vec3 o, vec3 d) {
  const GroupRay ray = group_ray(at, o, d);
  const UnitDirection unit = unit_direction(ray.d);
  PrimitivePoint r = point_on_curve(load_quadric(scene->quadrics + quadric), ray.o, unit.d);
  r.distance /= unit.length;
  return placed_point(at, r);
}

/// The index of the primitive's quadric, if that is a curve, else -1.
FN int curve_of(const PRIVATE Scene* scene, int primitive) {
  const int quadric = primitive - scene->header.tables.triangles.count;
  return quadric >= 0 && is_curve_kind(scene->quadrics[quadric].kind) ? quadric : -1;
}

/// Adds the texture coordinates of a curve's point.
FN Surface with_curve_uv(const PRIVATE Scene* scene, int quadric, PrimitivePoint r, Surface s) {
  const QuadricUv uv = curve_uv(load_quadric(scene->quadrics + quadric), r);
  return with_uv(s, uv.at, r.normal, uv.du);
}
FN Surface with_instance_curve_uv(const PRIVATE Scene* scene, int quadric, Instance at, PrimitivePoint r,
                                  Surface s) {
  const QuadricUv uv = curve_uv(load_quadric(scene->quadrics + quadric), r);
  return with_uv(s, uv.at, r.normal, from_group_vector(at, uv.du));
}

/// The surface of a ray that met `primitive` at the point `r`, without texture coordinates; -1: no hit.
FN Surface seen_surface(int primitive, vec3 o, vec3 d, PrimitivePoint r) {
  Surface s;
  s.primitive = primitive;
  s.from = o;
  s.wo = negate(d);
  s.p = r.p;
  s.distance = r.distance;
  s.error = POSITION_ERROR * dot3(abs3(r.normal), r.extent);
  s.front = dot3(r.normal, s.wo) > 0.0f;
  const float side = s.front ? 1.0f : -1.0f;
  s.geometric = scale(r.normal, side);
  s.shading = scale(r.shading, side);
  // The geometric normal alone decides which side is seen, since rays meet the geometry. The shading normal
  // is used if it faces the viewer, which it may not near the silhouette of a mesh.
  const bool faces = (dot3(s.shading, s.wo) > 0.0f) & (dot3(s.shading, s.geometric) > 0.0f);
  s.shading = select3(faces, s.shading, s.geometric);
  s.material = primitive >= 0 ? (s.front ? r.front : r.back) : 0;
  s.light = primitive >= 0 ? r.light : -1;
  return without_uv(s);
}

/// With the tangents of the vertices of a triangle that does not move within its group.
FN Surface with_tangents_of(const PRIVATE Scene* scene, int primitive, bool instanced, Instance at,
                            PrimitivePoint r, Surface s) {
  if (primitive < 0 || primitive >= scene->header.tables.vertex_tangents.count) return s;
  GLOBAL const Triangle* t = scene->triangles + primitive;
  return with_vertex_tangents(scene, primitive, load3(&t->p0), load3(&t->p1), load3(&t->p2), instanced, at, r,
                              s);
}

/// Like surface_at, for a primitive of an instance.
FN Surface surface_at_instance(const PRIVATE Scene* scene, int primitive, int instance, vec3 o, vec3 d) {
  const Instance at = load_instance(scene->instances + instance);
  const int curve = NEEDS(scene, CURVES) ? curve_of(scene, primitive) : -1;
  const PrimitivePoint r = HAS(CURVES) && curve >= 0 ? instance_curve_point(scene, curve, at, o, d)
                                                     : instance_point(scene, primitive, at, o, d);
  Surface s = seen_surface(primitive, o, d, r);
  s.instance = instance;
  if (NEEDS(scene, UV))
    s = HAS(CURVES) && curve >= 0 ? with_instance_curve_uv(scene, curve, at, r, s)
                                  : with_instance_uv(scene, primitive, at, r, s);
  if (NEEDS(scene, TANGENTS)) s = with_tangents_of(scene, primitive, true, at, r, s);
  return s;
}

/// The surface that the ray from `o` along the unit direction `d` meets on the primitive; -1: no hit. Stages
/// for LANES paths use find_hit_surfaces.
FN Surface surface_at(const PRIVATE Scene* scene, int primitive, vec3 o, vec3 d) {
  const int triangle = triangle_of(scene, primitive);
  PrimitivePoint r = triangle_point(scene, triangle, o, d);
  if (NEEDS(scene, SHADING_NORMALS)) r.shading = interpolated_normal(scene, triangle, r);
  const int quadric = primitive - scene->header.tables.triangles.count;
  if (NEEDS(scene, QUADRICS) && (quadric >= 0))
    r = point_on_quadric(load_quadric(scene->quadrics + quadric), o, d);
  const int curve = NEEDS(scene, CURVES) ? curve_of(scene, primitive) : -1;
  if (HAS(CURVES) && curve >= 0) r = point_on_curve(load_quadric(scene->quadrics + curve), o, d);
  Surface s = seen_surface(primitive, o, d, r);
  if (NEEDS(scene, UV)) s = with_triangle_uv(scene, triangle, r, s);
  if (NEEDS(scene, UV) && NEEDS(scene, QUADRICS) && (quadric >= 0)) s = with_quadric_uv(scene, quadric, r, s);
  if (NEEDS(scene, UV) && HAS(CURVES) && curve >= 0) s = with_curve_uv(scene, curve, r, s);
  if (NEEDS(scene, TANGENTS))
    s = with_tangents_of(scene, primitive, false, load_instance(scene->instances), r, s);
  return s;
}

/// Whether the direction is on one side of the surface by the geometric normal and on the other by the
/// shading normal. No light passes there: every strategy treats the direction as shadowed by the surface
/// itself. So the strategies agree, and no light leaks into closed rooms or through sheets.
FN bool is_beneath(Surface s, vec3 wi) {
  return (dot3(s.geometric, wi) > 0.0f) != (dot3(s.shading, wi) > 0.0f);
}

/// An origin for a ray that leaves the surface along `direction`: offset by `error`, so that it is on the
/// correct side despite rounding.
FN vec3 leave_surface(vec3 p, vec3 normal, float error, vec3 direction) {
  return add_scaled(p, dot3(direction, normal) < 0.0f ? -error : error, normal);
}

PENUMBRA_NAMESPACE_END
#endif
