// Spheres, disks and cylinders, and pieces of curves.
#ifndef PENUMBRA_QUADRIC_H
#define PENUMBRA_QUADRIC_H
#include "kernels/intersect/curve.h"
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Distance along the unit direction `d` to the nearest point of the sphere in front of `o`, or a negative
/// number. The discriminant uses the ray's closest point to the centre, which is accurate for distant and
/// large spheres (Haines, Guenther and Akenine-Moeller, Ray Tracing Gems 2019, ch. 7).
FN float intersect_sphere(vec3 o, vec3 d, vec3 center, float radius) {
  vec3 f = sub(o, center);
  float b = -dot3(f, d);
  vec3 closest = add_scaled(f, b, d);
  float discriminant = sqr(radius) - dot3(closest, closest);
  float root = safe_sqrt(discriminant);
  float q = b >= 0.0f ? b + root : b - root;
  float c = dot3(f, f) - sqr(radius);
  float t0 = q != 0.0f ? c / q : 0.0f;
  float near = min_f(t0, q), far = max_f(t0, q);
  float t = near > 0.0f ? near : far;
  return discriminant >= 0.0f ? t : -1.0f;
}

/// Distance along `d` to the disk, or a negative number.
FN float intersect_disk(vec3 o, vec3 d, vec3 center, vec3 normal, float radius) {
  float cosine = dot3(normal, d);
  vec3 to_center = sub(center, o);
  float t = cosine != 0.0f ? dot3(normal, to_center) / cosine : -1.0f;
  vec3 offset = sub(scale(d, t), to_center);
  return dot3(offset, offset) <= sqr(radius) ? t : -1.0f;
}

/// Distance along the unit direction `d` to the nearest point in front of `o` of a cylinder without caps, or
/// a negative number. The cylinder's axis starts at `center` and extends by `length` along the unit `axis`.
/// As for spheres, the discriminant uses the ray's closest point to the axis.
FN float intersect_cylinder(vec3 o, vec3 d, vec3 center, vec3 axis, float radius, float length) {
  const vec3 f = sub(o, center);
  const float height = dot3(f, axis), climb = dot3(d, axis);
  const vec3 f_across = add_scaled(f, -height, axis), d_across = add_scaled(d, -climb, axis);
  const float a = dot3(d_across, d_across), inverse = a > 0.0f ? 1.0f / a : 0.0f;
  const float b = -dot3(f_across, d_across);
  const vec3 closest = add_scaled(f_across, b * inverse, d_across);
  const float discriminant = sqr(radius) - dot3(closest, closest);
  const float root = safe_sqrt(a * discriminant);
  const float q = b >= 0.0f ? b + root : b - root;
  const float c = dot3(f_across, f_across) - sqr(radius);
  const float t0 = q != 0.0f ? c / q : 0.0f, t1 = q * inverse;
  const float near = min_f(t0, t1), far = max_f(t0, t1);
  const float near_height = height + near * climb, far_height = height + far * climb;
  const bool meets = (discriminant >= 0.0f) & (a > 0.0f);
  const bool near_is_there = meets & (near > 0.0f) & (near_height >= 0.0f) & (near_height <= length);
  const bool far_is_there = meets & (far_height >= 0.0f) & (far_height <= length);
  return near_is_there ? near : (far_is_there ? far : -1.0f);
}

/// Quadrics that are no cylinders.
FN float intersect_sphere_or_disk(Quadric q, vec3 o, vec3 d) {
  float sphere = intersect_sphere(o, d, q.center, q.radius);
  float disk = intersect_disk(o, d, q.center, q.normal, q.radius);
  return q.kind == QUADRIC_DISK ? disk : sphere;
}

FN float intersect_quadric(Quadric q, vec3 o, vec3 d) {
  if (HAS(CYLINDERS) && q.kind == QUADRIC_CYLINDER)
    return intersect_cylinder(o, d, q.center, q.normal, q.radius, q.length);
  if (HAS(CURVES) && is_curve_kind(q.kind))
    return may_meet_curve(q, o, d) ? intersect_curve(curve_piece(q), o, d) : -1.0f;
  return intersect_sphere_or_disk(q, o, d);
}

PENUMBRA_NAMESPACE_END
#endif
