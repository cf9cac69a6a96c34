// The kinds of lights: their numbers, the kinds that kernels are compiled for, and those that a scene has.
#ifndef PENUMBRA_LIGHT_KINDS_H
#define PENUMBRA_LIGHT_KINDS_H
#include "kernels/features.h"
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

// X(name, NAME, number, strategies, description for users). The file <name>_light.h implements a kind:
// sample_<name>_light, <name>_light_pdf and <name>_light_radiance; light.h includes it. `strategies`: the
// features that change how the kind is sampled or what its points store; a scene has some of them or none.
#define LIGHT_KINDS(X)                                                                                    \
  X(triangle, TRIANGLE, 0, FEATURE_SOLID_ANGLE | FEATURE_PROJECTED | FEATURE_UV | FEATURE_LIGHT_TEXTURES, \
    "triangles that emit")                                                                                \
  X(sphere, SPHERE, 1, FEATURE_UV | FEATURE_LIGHT_TEXTURES, "spheres that emit")                          \
  X(disk, DISK, 2, FEATURE_UV | FEATURE_LIGHT_TEXTURES, "disks that emit")                                \
  X(point, POINT, 3, 0, "point lights")                                                                   \
  X(environment, ENVIRONMENT, 4, 0, "environment light")                                                  \
  X(rectangle, RECTANGLE, 5, FEATURE_SOLID_ANGLE | FEATURE_UV,                                            \
    "rectangles that emit, each of two triangles")                                                        \
  X(envmap, ENVMAP, 6, 0, "environment map")                                                              \
  X(spot, SPOT, 7, FEATURE_LIGHT_TEXTURES, "spot lights")                                                 \
  X(directional, DIRECTIONAL, 8, 0, "directional lights")                                                 \
  X(projector, PROJECTOR, 9, FEATURE_LIGHT_TEXTURES, "projectors")                                        \
  X(cylinder, CYLINDER, 10, FEATURE_UV | FEATURE_LIGHT_TEXTURES, "cylinders that emit")                   \
  X(medium, MEDIUM, 11, 0, "grids of media that emit")                                                    \
  X(sun, SUN, 12, 0, "suns: disks at infinity")                                                           \
  X(round_spot, ROUND_SPOT, 13, FEATURE_LIGHT_TEXTURES, "spot lights with a radius")

#define LIGHT_GRID_STEPS 7
#define MOST_LIGHT_GRID_SIDE 128  // 2^LIGHT_GRID_STEPS: cells of a textured light along one axis

// Rows of SCENE_TABLES for tables that only some kinds have.
#define LIGHT_TABLES(T, A)                                                            \
  /* See envmap_light.h. */                                                           \
  T(A, envmaps, EnvironmentMap, 1, "environment maps")                                \
  T(A, envmap_texels, vec3, 1, "texels of environment maps")                          \
  T(A, envmap_rows, float, 2, "distribution over the rows of environment maps")       \
  T(A, envmap_columns, float, 2, "distribution over the columns of environment maps") \
  /* See delta_lights.h. */                                                           \
  T(A, beams, Beam, 1, "beams of spot lights and projectors")                         \
  /* See light_grid.h. */                                                             \
  T(A, light_grids, float, 3, "distributions over textured lights")                   \
  /* See medium_light.h. */                                                           \
  T(A, glows, Glow, 1, "media that are lights")                                       \
  T(A, glow_blocks, GlowBlock, 1, "distributions over media")

#define ENUMERATE_KIND(name, NAME, number, strategies, description) LIGHT_##NAME = number,
#define COUNT_KIND(name, NAME, number, strategies, description) +1
enum { LIGHT_KINDS(ENUMERATE_KIND) LIGHT_KIND_COUNT = 0 LIGHT_KINDS(COUNT_KIND) };
#undef ENUMERATE_KIND
#undef COUNT_KIND

#define KIND_BIT(name, NAME, number, strategies, description) | 1u << (number)
#define ALL_LIGHT_KINDS (0u LIGHT_KINDS(KIND_BIT))
// Bits 1 << LIGHT_*. OpenCL kernels are compiled for exactly the kinds of a scene. Native code is compiled
// for all kinds and does not call those that the scene lacks.
#ifndef LIGHT_KINDS_MASK
  #define LIGHT_KINDS_MASK ALL_LIGHT_KINDS
#endif
// A copy of the mask, since it must not be expanded within the expansion of LIGHT_KINDS.
enum { COMPILED_LIGHT_KINDS = LIGHT_KINDS_MASK };
#define HAS_LIGHT_OF(number) ((COMPILED_LIGHT_KINDS & (1u << (number))) != 0u)
/// Whether light of that kind is a beam, see delta_lights.h.
FN bool is_beam_light(int kind) {
  return (kind == LIGHT_SPOT) | (kind == LIGHT_PROJECTOR) | (kind == LIGHT_ROUND_SPOT);
}
/// Whether light of that kind comes from a single point, or from a small sphere about it.
FN bool is_point_of_light(int kind) { return (kind == LIGHT_POINT) | is_beam_light(kind); }
/// Whether light of that kind comes from infinity.
FN bool is_infinite_light(int kind) {
  return (kind == LIGHT_DIRECTIONAL) | (kind == LIGHT_SUN) | (kind == LIGHT_ENVIRONMENT) |
         (kind == LIGHT_ENVMAP);
}
#define HAS_LIGHT(NAME) (((LIGHT_KINDS_MASK) >> LIGHT_##NAME & 1u) != 0u)
#define SCENE_LIGHT_KINDS(h) NEEDED(LIGHT_KINDS_MASK, (h)->light_kinds)
#define NEEDS_LIGHT(scene, NAME) \
  (HAS_LIGHT(NAME) && (SCENE_LIGHT_KINDS(&(scene)->header) >> LIGHT_##NAME & 1u) != 0u)
/// Whether media are lights, see medium_light.h.
#define NEEDS_GLOWS(scene) (NEEDS_EMITTING_MEDIA(scene) && NEEDS_LIGHT(scene, MEDIUM))

PENUMBRA_NAMESPACE_END
#endif
