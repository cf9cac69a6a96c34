// What is known of the place where a ray ends: computed once for each hit, and read by whatever needs it.
#ifndef PENUMBRA_SURFACE_FIELDS_H
#define PENUMBRA_SURFACE_FIELDS_H
#include "kernels/math/lane_record.h"

PENUMBRA_NAMESPACE_BEGIN

// clang-format off
// What every scene needs to know.
#define SURFACE_HIT_FIELDS(F, a)                                                                        \
  F(a, int, primitive)   /* NOTHING_HIT: `material` is 0, which absorbs everything, the rest means nothing; IN_MEDIUM */ \
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
// What textures and frames along them need: scenes with FEATURE_UV alone. Elsewhere lanes hold nothing here.
#define SURFACE_UV_FIELDS(F, a)                                                                          \
  F(a, float, u)         /* texture coordinates */                                                       \
  F(a, float, v)                                                                                         \
  F(a, vec3, tangent)    /* unit, where u grows in the tangent plane of the primitive: see tangent_axis */ \
  F(a, vec3, smooth)     /* unit shading normal before a texture bent it */                              \
  F(a, float, bumps)     /* squared roughness of the bumps that bent it: see bump_shadow */
// Scenes with FEATURE_INSTANCES alone.
#define SURFACE_INSTANCE_FIELDS(F, a) F(a, int, instance)  /* that the primitive is a part of, or -1 */
// Scenes with FEATURE_MEDIA alone.
#define SURFACE_MEDIA_FIELDS(F, a) F(a, float, span)  /* the largest number that p was computed from */
#define SURFACE_FIELDS(F, a) \
  SURFACE_HIT_FIELDS(F, a) SURFACE_UV_FIELDS(F, a) SURFACE_INSTANCE_FIELDS(F, a) SURFACE_MEDIA_FIELDS(F, a)
// clang-format on
LANE_RECORD(Surface, Surfaces, surface, SURFACE_FIELDS)
LANE_RECORD_PART(Surface, Surfaces, surface_hit, SURFACE_HIT_FIELDS)
LANE_RECORD_PART(Surface, Surfaces, surface_uv, SURFACE_UV_FIELDS)

// A surface before it is known which side is seen. `extent` bounds what the position was computed from, by
// coordinate; b0, b1 and b2 are a triangle's barycentric coordinates, `front` and `back` materials.
#define PRIMITIVE_POINT_FIELDS(F, a) \
  F(a, vec3, p)                      \
  F(a, vec3, extent)                 \
  F(a, vec3, normal)                 \
  F(a, vec3, shading)                \
  F(a, float, distance)              \
  F(a, float, b0)                    \
  F(a, float, b1)                    \
  F(a, float, b2)                    \
  F(a, int, front)                   \
  F(a, int, back)                    \
  F(a, int, light)
LANE_RECORD(PrimitivePoint, PrimitivePoints, primitive_point, PRIMITIVE_POINT_FIELDS)

// In the place of a primitive.
#define NOTHING_HIT -1
#define IN_MEDIUM -2

/// Whether the ray ended somewhere: at a surface, or in a medium.
FN bool is_hit(Surface s) { return s.primitive != NOTHING_HIT; }

/// Outside of instances and media too.
FN Surface without_uv(Surface s) {
  s.u = s.v = s.span = 0.0f;
  s.tangent = s.smooth = make_vec3(0.0f, 0.0f, 0.0f);
  s.bumps = 0.0f;
  s.instance = -1;
  return s;
}

/// A point of a medium, in the place of a surface: without normals, and no part of anything.
FN Surface surface_in_medium(vec3 p) {
  const vec3 zero = make_vec3(0.0f, 0.0f, 0.0f);
  Surface s;
  s.primitive = IN_MEDIUM;
  s.light = -1;
  s.front = false;
  s.from = s.p = p;
  s.error = s.distance = 0.0f;
  s.geometric = s.shading = s.wo = zero;
  s.material = 0;
  return without_uv(s);
}

PENUMBRA_NAMESPACE_END
#endif
