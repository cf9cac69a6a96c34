// Where a ray meets a primitive. The intersector answers which primitive; this recomputes where from the
// primitive itself, so that all intersectors agree and positions stay exact far along a ray.
#ifndef PENUMBRA_SURFACE_H
#define PENUMBRA_SURFACE_H
#include "kernels/intersect/quadric.h"
#include "kernels/intersect/triangle.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  bool valid;      ///< false: nothing was hit; the other fields mean nothing, but `material` exists
  bool front;      ///< seen from the front side
  vec3 p;          ///< relative to the scene's centre
  float error;     ///< how far p may be off the true surface along `geometric`
  vec3 geometric;  ///< unit normal on the side of the viewer
  vec3 shading;    ///< unit shading normal, on the same side and facing the viewer
  vec3 wo;         ///< unit, back along the ray
  float distance;  ///< along the ray
  int material;
  int light;  ///< or -1
} Surface;

// Rounding of b0 p0 + b1 p1 + b2 p2 with rounded barycentrics, gamma(7), doubled: it also covers the rounding
// of the offset origin itself (Pharr, Jakob and Humphreys 2016, section 3.9).
#define POSITION_ERROR (16.0f * HALF_EPSILON)

FN Surface surface_at(const PRIVATE Scene* scene, int primitive, vec3 o, vec3 d) {
  Surface s;
  s.valid = primitive >= 0;
  s.wo = negate(d);
  const int index = s.valid ? primitive : 0;
#if HAS(QUADRICS)
  const int triangle_count = scene->header.tables.triangles.count;
  const bool is_quadric = s.valid & (index >= triangle_count);
  GLOBAL const Triangle* triangle = scene->triangles + (is_quadric ? 0 : index);
#else
  GLOBAL const Triangle* triangle = scene->triangles + index;
#endif
  const vec3 p0 = load3(&triangle->p0), p1 = load3(&triangle->p1), p2 = load3(&triangle->p2);
  Shear shear = make_shear(d);
  TriangleHit h = intersect_sheared(shear_point(shear, sub(p0, o)), shear_point(shear, sub(p1, o)),
                                    shear_point(shear, sub(p2, o)));
  const float inverse = h.det != 0.0f ? 1.0f / h.det : 0.0f;
  const float b0 = h.u * inverse, b1 = h.v * inverse, b2 = h.w * inverse;
  const vec3 q0 = scale(p0, b0), q1 = scale(p1, b1), q2 = scale(p2, b2);
  s.p = add(add(q0, q1), q2);
  const vec3 spread = add(add(abs3(q0), abs3(q1)), abs3(q2));
  vec3 normal = normalize3(cross3(sub(p1, p0), sub(p2, p0)));
  vec3 shading = normal;
#if HAS(SHADING_NORMALS)
  {
    const int at = triangle->normals;
    GLOBAL const VertexNormals* n = scene->normals + (at >= 0 ? at : 0);
    vec3 blend = add(add(scale(load3(&n->n0), b0), scale(load3(&n->n1), b1)), scale(load3(&n->n2), b2));
    const float length2 = dot3(blend, blend);
    blend = scale(blend, 1.0f / SQRT(max_f(length2, 1e-30f)));
    shading = select3((at >= 0) & (length2 > 1e-12f), blend, normal);
  }
#endif
  s.distance = h.t;
  vec3 extent = spread;
  int front = triangle->front, back = triangle->back;
  s.light = triangle->light;
#if HAS(QUADRICS)
  {
    GLOBAL const Quadric* q = scene->quadrics + (is_quadric ? index - triangle_count : 0);
    const bool sphere = q->kind == QUADRIC_SPHERE;
    const vec3 center = load3(&q->center), disk_normal = load3(&q->normal);
    const float radius = q->radius;
    const float t_sphere = intersect_sphere(o, d, center, radius);
    const float t_disk = intersect_disk(o, d, center, disk_normal, radius);
    const float t = sphere ? t_sphere : t_disk;
    const vec3 at = add_scaled(o, t, d);
    const vec3 outward = normalize3(sub(at, center));
    // Back onto the surface: radially for a sphere, along the normal for a disk.
    const vec3 on_sphere = add_scaled(center, radius, outward);
    const vec3 on_disk = add_scaled(at, -dot3(sub(at, center), disk_normal), disk_normal);
    const vec3 quadric_normal = select3(sphere, scale(outward, q->orientation), disk_normal);
    s.p = select3(is_quadric, select3(sphere, on_sphere, on_disk), s.p);
    extent = select3(is_quadric, add(abs3(center), make_vec3(radius, radius, radius)), extent);
    normal = select3(is_quadric, quadric_normal, normal);
    shading = select3(is_quadric, quadric_normal, shading);
    s.distance = is_quadric ? t : s.distance;
    front = is_quadric ? q->front : front;
    back = is_quadric ? q->back : back;
    s.light = is_quadric ? q->light : s.light;
  }
#endif
  s.error = POSITION_ERROR * dot3(abs3(normal), extent);
  s.front = dot3(normal, s.wo) > 0.0f;
  const float side = s.front ? 1.0f : -1.0f;
  s.geometric = scale(normal, side);
  s.shading = scale(shading, side);
#if HAS(SHADING_NORMALS)
  // The geometric normal alone says which side is seen: it is what rays meet. An interpolated one shapes the
  // light of that side as long as it faces the viewer, which at the rim of a mesh it need not.
  const bool faces = (dot3(s.shading, s.wo) > 0.0f) & (dot3(s.shading, s.geometric) > 0.0f);
  s.shading = select3(faces, s.shading, s.geometric);
#endif
  s.material = s.front ? front : back;
  s.light = s.valid ? s.light : -1;
  return s;
}

/// Whether the direction is beneath the surface, on the side that the viewer does not see. An interpolated
/// normal's hemisphere reaches there, but nothing gets through: every strategy takes light from there to be
/// in the surface's own shadow, so that they agree, and none leaks into closed rooms or through sheets.
FN bool is_beneath(Surface s, vec3 wi) {
#if HAS(SHADING_NORMALS)
  return dot3(s.geometric, wi) <= 0.0f;
#else
  return false;
#endif
}

/// An origin for a ray that leaves the surface along `direction`, on the right side of it whatever the
/// rounding.
FN vec3 leave_surface(vec3 p, vec3 normal, float error, vec3 direction) {
  return add_scaled(p, dot3(direction, normal) < 0.0f ? -error : error, normal);
}

PENUMBRA_NAMESPACE_END
#endif
