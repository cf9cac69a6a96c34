// Watertight ray-triangle intersection.
#ifndef PENUMBRA_TRIANGLE_H
#define PENUMBRA_TRIANGLE_H
#include "kernels/math/lane_record.h"
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// The affine map that takes a ray to the positive z axis (Woop, Benthin and Wald 2013): permute the axes so
/// that the direction's largest component is z, shear x and y, scale z. A vertex maps to the same point for
/// every triangle that shares it. An edge function is the difference of two rounded products: its sign is
/// never wrong, it may only become 0. Since 0 counts as inside, no ray slips between neighbours.
#define SHEAR_FIELDS(F, a)                                         \
  F(a, int, axis) /* 0, 1, 2: the direction's largest component */ \
  F(a, float, x)                                                   \
  F(a, float, y)                                                   \
  F(a, float, z)
LANE_RECORD(Shear, Shears, shear, SHEAR_FIELDS)

/// 0, 1 or 2; the last one if components are equal.
FN int largest_axis(vec3 d) {
  const float ax = FABS(d.x), ay = FABS(d.y), az = FABS(d.z);
  const int first = (ax > ay) & (ax > az), second = (ay > az) & !first;
  return 2 - 2 * first - second;
}

FN Shear make_shear(vec3 d) {
  const int axis = largest_axis(d);
  const bool first = axis == 0, second = axis == 1;
  float dx = first ? d.y : (second ? d.z : d.x);
  float dy = first ? d.z : (second ? d.x : d.y);
  float dz = first ? d.x : (second ? d.y : d.z);
  Shear s;
  s.axis = axis;
  s.z = 1.0f / dz;
  s.x = dx * s.z;
  s.y = dy * s.z;
  return s;
}

/// Shears a point whose axes are already permuted.
FN vec3 shear_permuted(Shear s, float x, float y, float z) {
  return make_vec3(x - s.x * z, y - s.y * z, s.z * z);
}

/// Permutes and shears `r`, a point relative to the ray's origin.
FN vec3 shear_point(Shear s, vec3 r) {
  bool first = s.axis == 0, second = s.axis == 1;
  float x = first ? r.y : (second ? r.z : r.x);
  float y = first ? r.z : (second ? r.x : r.y);
  float z = first ? r.x : (second ? r.y : r.z);
  return shear_permuted(s, x, y, z);
}

/// `t` is the distance to the triangle's plane. `inside`: the ray meets the triangle, from either side. If
/// so, u / det, v / det and w / det are the barycentric coordinates of a, b and c. A triangle seen edge-on
/// has det 0 and a `t` that is not finite, so that no comparison accepts it.
typedef struct {
  float u, v, w, det, t;
  bool inside;
} TriangleHit;

FN TriangleHit intersect_sheared(vec3 a, vec3 b, vec3 c) {
  TriangleHit h;
  h.u = c.x * b.y - c.y * b.x;
  h.v = a.x * c.y - a.y * c.x;
  h.w = b.x * a.y - b.y * a.x;
  float low = min_f(min_f(h.u, h.v), h.w);
  float high = max_f(max_f(h.u, h.v), h.w);
  h.inside = (low >= 0.0f) | (high <= 0.0f);
  h.det = h.u + h.v + h.w;
  h.t = (h.u * a.z + h.v * b.z + h.w * c.z) / h.det;
  return h;
}

PENUMBRA_NAMESPACE_END
#endif
