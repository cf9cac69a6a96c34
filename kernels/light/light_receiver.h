// What is lit: a point of a surface, or of a medium.
#ifndef PENUMBRA_LIGHT_RECEIVER_H
#define PENUMBRA_LIGHT_RECEIVER_H
#include "kernels/intersect/surface.h"

PENUMBRA_NAMESPACE_BEGIN

// clang-format off
#define LIGHT_RECEIVER_FIELDS(F, a)                                                                       \
  F(a, vec3, p)                                                                                           \
  F(a, float, error)     /* see Surface; 0 without a normal, so that no ray's origin is offset */         \
  F(a, vec3, geometric)  /* likewise; 0 without a normal */                                               \
  F(a, vec3, shading)    /* likewise */                                                                   \
  F(a, bool, has_normal) /* false: a point of a medium, which light reaches from all directions */        \
  F(a, bool, front)      /* the surface is seen from its front side */                                    \
  F(a, int, light)       /* that the surface is a part of, or -1 */
// clang-format on
LANE_RECORD(LightReceiver, LightReceivers, receiver, LIGHT_RECEIVER_FIELDS)

FN LightReceiver receiver_of(Surface s) {
  LightReceiver r;
  r.p = s.p;
  r.error = s.error;
  r.geometric = s.geometric;
  r.shading = s.shading;
  r.has_normal = true;
  r.front = s.front;
  r.light = s.light;
  return r;
}

FN LightReceiver receiver_in_medium(vec3 p) {
  LightReceiver r;
  r.p = p;
  r.error = 0.0f;
  r.geometric = r.shading = make_vec3(0.0f, 0.0f, 0.0f);
  r.has_normal = r.front = false;
  r.light = -1;
  return r;
}

PENUMBRA_NAMESPACE_END
#endif
