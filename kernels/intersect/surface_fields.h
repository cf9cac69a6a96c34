// What is known of the place where a ray ends: computed once for each hit, and read by whatever needs it.
#ifndef PENUMBRA_SURFACE_FIELDS_H
#define PENUMBRA_SURFACE_FIELDS_H
#include "kernels/math/lane_record.h"

PENUMBRA_NAMESPACE_BEGIN

// clang-format off
#define SURFACE_FIELDS(F, a)                                                                            \
  F(a, int, primitive)   /* -1: nothing was hit; `material` is 0, which absorbs everything, the rest means nothing */ \
  F(a, bool, front)      /* seen from the front side */                                                 \
  F(a, vec3, from)       /* the ray's origin */                                                         \
  F(a, vec3, p)          /* relative to the scene's centre */                                           \
  F(a, float, error)     /* how far p may be off the true surface along `geometric` */                  \
  F(a, vec3, geometric)  /* unit normal on the side of the viewer */                                    \
  F(a, vec3, shading)    /* unit shading normal, on the same side and facing the viewer */              \
  F(a, vec3, wo)         /* unit, back along the ray */                                                 \
  F(a, float, distance)  /* along the ray */                                                            \
  F(a, int, material)                                                                                   \
  F(a, int, light)       /* that it is a part of, or -1 */
// clang-format on
LANE_RECORD(Surface, Surfaces, surface, SURFACE_FIELDS)

FN bool is_hit(Surface s) { return s.primitive >= 0; }

/// A point of a medium, in the place of a surface: without normals, and no part of anything.
FN Surface surface_in_medium(vec3 p) {
  const vec3 zero = make_vec3(0.0f, 0.0f, 0.0f);
  Surface s;
  s.primitive = s.light = -1;
  s.front = false;
  s.from = s.p = p;
  s.error = s.distance = 0.0f;
  s.geometric = s.shading = s.wo = zero;
  s.material = 0;
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
