// Instances: groups of shapes that are stored once and placed several times. Rays are transformed to a
// group's own space, and hits are transformed back.
#ifndef PENUMBRA_INSTANCE_H
#define PENUMBRA_INSTANCE_H
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

FN vec3 to_group_vector(Instance at, vec3 v) {
  return make_vec3(dot3(at.row_x, v), dot3(at.row_y, v), dot3(at.row_z, v));
}
FN vec3 to_group_point(Instance at, vec3 p) { return to_group_vector(at, sub(p, at.at)); }

FN vec3 from_group_vector(Instance at, vec3 v) {
  return add(add(scale(at.x, v.x), scale(at.y, v.y)), scale(at.z, v.z));
}
FN vec3 from_group_point(Instance at, vec3 p) { return add(from_group_vector(at, p), at.at); }

/// Normalises vectors of any length that floats can hold.
FN vec3 normalize_any(vec3 v) {
  const vec3 w = scale(v, 1.0f / max_f(max_component(abs3(v)), 1e-37f));
  const float length2 = dot3(w, w);
  return scale(w, 1.0f / SQRT(length2 > 0.0f ? length2 : 1.0f));
}

/// The group's normal as a unit normal in the scene, on the same side.
FN vec3 from_group_normal(Instance at, vec3 n) {
  return normalize_any(add(add(scale(at.row_x, n.x), scale(at.row_y, n.y)), scale(at.row_z, n.z)));
}

/// A ray in the space of a group. Its direction is not normalised, so that distances along it are those in
/// the scene.
typedef struct {
  vec3 o, d;
} GroupRay;

FN GroupRay group_ray(Instance at, vec3 o, vec3 d) {
  GroupRay r;
  r.o = to_group_point(at, o);
  r.d = to_group_vector(at, d);
  return r;
}

/// A direction, normalised, and its length before.
typedef struct {
  vec3 d;
  float length;
} UnitDirection;

FN UnitDirection unit_direction(vec3 d) {
  const float largest = max_f(max_component(abs3(d)), 1e-37f);
  const vec3 w = scale(d, 1.0f / largest);
  const float length = SQRT(dot3(w, w));
  UnitDirection u;
  u.d = scale(w, 1.0f / length);
  u.length = largest * length;
  return u;
}

/// An error bound for a position in the scene that is transformed from a group's point, by coordinate: the
/// sum of the absolute values that it was computed from, where `extent` is that of the group's point. The
/// transforms add at most 5 roundings in each direction, where a position has 7 (see POSITION_ERROR). A ray
/// that starts there goes through the inverse transform first.
FN vec3 from_group_extent(Instance at, vec3 extent, vec3 p) {
  const vec3 q = abs3(sub(p, at.at));
  const vec3 back = make_vec3(dot3(abs3(at.row_x), q), dot3(abs3(at.row_y), q), dot3(abs3(at.row_z), q));
  const vec3 e = add(scale(extent, 2.0f), back);
  const vec3 there = add(add(scale(abs3(at.x), e.x), scale(abs3(at.y), e.y)), scale(abs3(at.z), e.z));
  return add(there, abs3(at.at));
}

PENUMBRA_NAMESPACE_END
#endif
