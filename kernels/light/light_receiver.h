// What is lit: a point of a surface, or of a medium.
#ifndef PENUMBRA_LIGHT_RECEIVER_H
#define PENUMBRA_LIGHT_RECEIVER_H
#include "kernels/intersect/surface.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 p;
  float error;      ///< see Surface; 0 without a normal, so that no ray's origin is offset
  vec3 geometric;   ///< likewise; 0 without a normal
  vec3 shading;     ///< likewise
  bool has_normal;  ///< false: a point of a medium, which light reaches from all directions
  bool front;       ///< the surface is seen from its front side
  int light;        ///< that the surface is a part of, or -1
} LightReceiver;

/// A point of a medium has no normal: see surface_in_medium.
FN LightReceiver receiver_of(Surface s) {
  LightReceiver r;
  r.p = s.p;
  r.error = s.error;
  r.geometric = s.geometric;
  r.shading = s.shading;
  r.has_normal = dot3(s.geometric, s.geometric) > 0.0f;
  r.front = s.front;
  r.light = s.light;
  return r;
}

PENUMBRA_NAMESPACE_END
#endif
