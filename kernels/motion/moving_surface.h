// The surfaces of what moves, at the time of a path.
#ifndef PENUMBRA_MOVING_SURFACE_H
#define PENUMBRA_MOVING_SURFACE_H
#include "kernels/intersect/surface.h"
#include "kernels/motion/motion.h"

PENUMBRA_NAMESPACE_BEGIN

/// Whether the primitive is a triangle that moves, or a quadric that does; `instance` is -1 for those.
FN bool is_moving_triangle(const PRIVATE Scene* scene, int primitive, int instance) {
  return (instance < 0) & (primitive >= 0) & (primitive < scene->header.tables.triangles.count) &
         triangle_moves(scene, primitive);
}
FN bool is_moving_quadric(const PRIVATE Scene* scene, int primitive, int instance) {
  const int quadric = primitive - scene->header.tables.triangles.count;
  return (instance < 0) & (quadric >= 0) & quadric_moves(scene, quadric);
}
FN bool is_moving_instance(const PRIVATE Scene* scene, int instance) {
  return (instance >= 0) & instance_moves(scene, instance);
}

// Of a record that does not move, these give an arbitrary one that does.
FN TriangleState triangle_state(const PRIVATE Scene* scene, int primitive, bool moves, float time) {
  return triangle_at(scene, moves ? primitive : scene->shutter->still_triangles, time);
}
FN Quadric quadric_state(const PRIVATE Scene* scene, int primitive, bool moves, float time) {
  const int quadric = primitive - scene->header.tables.triangles.count;
  return quadric_at(scene, moves ? quadric : scene->shutter->still_quadrics, time);
}
FN Instance instance_state(const PRIVATE Scene* scene, int instance, bool moves, float time) {
  return instance_at(scene, moves ? instance : scene->shutter->still_instances, time);
}

/// Where the point of a surface on a moving triangle is if the triangle's vertices are p0, p1, p2.
FN vec3 carried_point(const PRIVATE Scene* scene, Surface s, vec3 p0, vec3 p1, vec3 p2) {
  const TriangleState now = triangle_at(scene, s.primitive, s.time);
  const Barycentric b = barycentric_among(now.p0, now.p1, now.p2, s.p);
  return add(add(scale(p0, b.b0), scale(p1, b.b1)), scale(p2, b.b2));
}

/// Where the record of a moving triangle has the surface's point.
FN vec3 rest_position(const PRIVATE Scene* scene, Surface s) {
  GLOBAL const Triangle* rest = scene->triangles + s.primitive;
  return carried_point(scene, s, load3(&rest->p0), load3(&rest->p1), load3(&rest->p2));
}

/// Where the ray from `o` along `d` meets the moving triangle.
FN PrimitivePoint moving_triangle_point(const PRIVATE Scene* scene, int triangle, TriangleState s, vec3 o,
                                        vec3 d) {
  GLOBAL const Triangle* record = scene->triangles + triangle;
  PrimitivePoint r = of_triangle(record, point_in_triangle(s.p0, s.p1, s.p2, o, d));
  if (HAS(SHADING_NORMALS)) r.shading = blended_normal(s.n0, s.n1, s.n2, record->normals >= 0, r);
  return r;
}

/// The position at `other` of what is at `s.p` on the surface at the path's time.
FN vec3 position_at(const PRIVATE Scene* scene, Surface s, float other) {
  if (!has_moving_surfaces(scene)) return s.p;
  if (is_moving_instance(scene, s.instance))
    return from_group_point(instance_at(scene, s.instance, other),
                            to_group_point(instance_at(scene, s.instance, s.time), s.p));
  if (is_moving_triangle(scene, s.primitive, s.instance)) {
    const TriangleState then = triangle_at(scene, s.primitive, other);
    return carried_point(scene, s, then.p0, then.p1, then.p2);
  }
  if (HAS(QUADRICS) && is_moving_quadric(scene, s.primitive, s.instance)) {
    const int quadric = s.primitive - scene->header.tables.triangles.count;
    const Quadric now = quadric_at(scene, quadric, s.time), then = quadric_at(scene, quadric, other);
    const vec3 from = to_quadric_frame(now, sub(s.p, now.center));
    const float wide = then.radius / now.radius;
    const float along = now.kind == QUADRIC_CYLINDER ? then.length / now.length : wide;
    const vec3 across = add(scale(then.x_axis, wide * from.x), scale(then.y_axis, wide * from.y));
    return add(then.center, add_scaled(across, along * from.z, then.normal));
  }
  return s.p;
}

PENUMBRA_NAMESPACE_END
#endif
