// The surface where a ray ends: computed once for each hit, and read wherever it is needed.
#ifndef PENUMBRA_SURFACE_FIELDS_H
#define PENUMBRA_SURFACE_FIELDS_H
#include "kernels/math/lane_record.h"

PENUMBRA_NAMESPACE_BEGIN

// clang-format off
// What every scene needs.
#define SURFACE_HIT_FIELDS(F, a)                                                                      \
  F(a, int, primitive)   /* or NOTHING_HIT (then `material` is 0, the rest arbitrary) or IN_MEDIUM */ \
  F(a, bool, front)      /* seen from the front side */                                               \
  F(a, vec3, from)       /* the ray's origin */                                                       \
  F(a, vec3, p)          /* relative to the scene's centre */                                         \
  F(a, float, error)     /* bound of the distance of p from the true surface along `geometric` */     \
  F(a, vec3, geometric)  /* unit normal on the side of wo */                                          \
  F(a, vec3, shading)    /* unit shading normal, on the same side and facing wo */                    \
  F(a, vec3, wo)         /* unit, from p back along the ray */                                        \
  F(a, float, distance)  /* along the ray */                                                          \
  F(a, int, material)                                                                                 \
  F(a, int, light)       /* its light, or -1 */
// For textures and tangent frames, with FEATURE_UV only. Otherwise lanes do not store these fields.
#define SURFACE_UV_FIELDS(F, a)                                                                       \
  F(a, float, u)         /* texture coordinates */                                                    \
  F(a, float, v)                                                                                      \
  F(a, vec3, tangent)    /* unit, direction of increasing u in the tangent plane: see tangent_axis */ \
  F(a, float, hand)      /* a normal map's second axis is hand * (normal x tangent) */                \
  F(a, vec3, smooth)     /* unit shading normal before normal or bump maps */                         \
  F(a, float, bumps)     /* squared roughness of the bumps that bent it: see bump_shadow */
// With FEATURE_INSTANCES only.
#define SURFACE_INSTANCE_FIELDS(F, a) F(a, int, instance)  /* instance of the primitive, or -1 */
// With FEATURE_MEDIA only.
#define SURFACE_MEDIA_FIELDS(F, a) F(a, float, span)  /* largest absolute value that p was computed from */
// With FEATURE_MOTION only.
#define SURFACE_MOTION_FIELDS(F, a) F(a, float, time)  /* at which the path sees it */
// With FEATURE_COAT_NORMALS only.
#define SURFACE_COAT_FIELDS(F, a) F(a, vec3, coat)  /* as `shading`, of a coat with a normal of its own */
#define SURFACE_FIELDS(F, a) \
  SURFACE_HIT_FIELDS(F, a) SURFACE_UV_FIELDS(F, a) SURFACE_INSTANCE_FIELDS(F, a) SURFACE_MEDIA_FIELDS(F, a) \
  SURFACE_MOTION_FIELDS(F, a) SURFACE_COAT_FIELDS(F, a)
// clang-format on
LANE_RECORD(Surface, Surfaces, surface, SURFACE_FIELDS)
LANE_RECORD_PART(Surface, Surfaces, surface_hit, SURFACE_HIT_FIELDS)
LANE_RECORD_PART(Surface, Surfaces, surface_uv, SURFACE_UV_FIELDS)

// A hit before it is known which side is seen. `extent` is the sum, by coordinate, of the absolute values
// that p was computed from. b0, b1 and b2 are a triangle's barycentric coordinates; `front` and `back` are
// materials.
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

// Values of `primitive` if there is no primitive.
#define NOTHING_HIT -1
#define IN_MEDIUM -2

/// Whether the ray ended at a surface or in a medium.
FN bool is_hit(Surface s) { return s.primitive != NOTHING_HIT; }

/// Sets the optional fields to their defaults: no texture coordinates, no instance.
FN Surface without_uv(Surface s) {
  s.u = s.v = s.span = s.time = 0.0f;
  s.tangent = s.smooth = s.coat = make_vec3(0.0f, 0.0f, 0.0f);
  s.hand = 1.0f;
  s.bumps = 0.0f;
  s.instance = -1;
  return s;
}

/// A scattering point in a medium, in place of a surface: it has no normals, light or instance.
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
