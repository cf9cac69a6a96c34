// What triangle and rectangle lights share: points of a plane.
#ifndef PENUMBRA_FLAT_LIGHT_H
#define PENUMBRA_FLAT_LIGHT_H
#include "kernels/light/light_sample.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 p0, p1, p2;
  vec3 normal;
} FlatLight;

FN FlatLight flat_light(GLOBAL const Light* light) {
  FlatLight f;
  f.p0 = load3(&light->p0);
  f.p1 = load3(&light->p1);
  f.p2 = load3(&light->p2);
  f.normal = normalize3(cross3(sub(f.p1, f.p0), sub(f.p2, f.p0)));
  return f;
}

/// The point b0 p0 + b1 p1 + b2 p2; `spread`: see toward_light.
FN LightPoint flat_light_point(FlatLight f, vec3 from, float b0, float b1, float b2, PRIVATE float* spread) {
  LightPoint at;
  const vec3 q0 = scale(f.p0, b0), q1 = scale(f.p1, b1), q2 = scale(f.p2, b2);
  at.p = add(add(q0, q1), q2);
  at.normal = f.normal;
  const vec3 extent = add(add(abs3(q0), abs3(q1)), abs3(q2));
  // Where a ray meets a triangle is known to a few roundings of its vertices seen from the ray's origin: a
  // point close to a large light would lie in its shadow otherwise.
  const float reach =
      max_f(max_component(abs3(sub(f.p0, from))),
            max_f(max_component(abs3(sub(f.p1, from))), max_component(abs3(sub(f.p2, from)))));
  *spread = max_f(dot3(abs3(f.normal), extent), reach);
  return at;
}

/// The point of the light's plane that is seen in direction w.
FN vec3 flat_light_seen(FlatLight f, vec3 from, vec3 w) {
  const float along = dot3(w, f.normal);
  const float distance = dot3(sub(f.p0, from), f.normal) / (along != 0.0f ? along : 1.0f);
  return add_scaled(from, distance, w);
}

PENUMBRA_NAMESPACE_END
#endif
