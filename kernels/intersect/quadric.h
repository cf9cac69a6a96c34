// Spheres and disks.
#ifndef PENUMBRA_QUADRIC_H
#define PENUMBRA_QUADRIC_H
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Distance along the unit direction `d` to the nearest point of the sphere in front of `o`, or a negative
/// number. The discriminant is that of the ray's closest point to the centre, which keeps distant and large
/// spheres round (Haines, Guenther and Akenine-Moeller, Ray Tracing Gems 2019, ch. 7).
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

FN float intersect_quadric(Quadric q, vec3 o, vec3 d) {
  float sphere = intersect_sphere(o, d, q.center, q.radius);
  float disk = intersect_disk(o, d, q.center, q.normal, q.radius);
  return q.kind == QUADRIC_DISK ? disk : sphere;
}

PENUMBRA_NAMESPACE_END
#endif
