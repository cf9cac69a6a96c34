// The kinds of textures: their numbers, and the record of a texture.
#ifndef PENUMBRA_TEXTURE_KINDS_H
#define PENUMBRA_TEXTURE_KINDS_H
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

// X(name, NAME, number, description for users). The file <name>_texture.h implements a kind by one function,
// <name>_texture; texture.h includes it.
#define TEXTURE_KINDS(X)                                          \
  X(checkerboard, CHECKERBOARD, 0, "checkerboards")               \
  X(byte_bitmap, BYTE_BITMAP, 1, "bitmaps of 8 bit")              \
  X(short_bitmap, SHORT_BITMAP, 2, "bitmaps of 16 bit")           \
  X(half_bitmap, HALF_BITMAP, 3, "bitmaps of half precision")     \
  X(float_bitmap, FLOAT_BITMAP, 4, "bitmaps of single precision") \
  X(scale, SCALE, 5, "scaled textures")                           \
  X(noise, NOISE, 6, "value noise")                               \
  X(mesh_attribute, MESH_ATTRIBUTE, 7, "colours of meshes")

#define ENUMERATE_KIND(name, NAME, number, description) TEXTURE_##NAME = number,
#define COUNT_KIND(name, NAME, number, description) +1
enum { TEXTURE_KINDS(ENUMERATE_KIND) TEXTURE_KIND_COUNT = 0 TEXTURE_KINDS(COUNT_KIND) };
#undef ENUMERATE_KIND
#undef COUNT_KIND

#define ALL_TEXTURE_KINDS ((1u << TEXTURE_KIND_COUNT) - 1u)
// Bits 1 << TEXTURE_*. OpenCL kernels are compiled for exactly the kinds of a scene. Native code is compiled
// for all kinds and does not call those that the scene lacks.
#ifndef TEXTURE_KINDS_MASK
  #define TEXTURE_KINDS_MASK ALL_TEXTURE_KINDS
#endif

#define LEAST_TEXELS 3  // words that kernels read whatever the textures

#define MAX_NOISE_OCTAVES 10

// How a bitmap continues beyond its edges.
#define WRAP_REPEAT 0
#define WRAP_MIRROR 1
#define WRAP_CLAMP 2
#define WRAP_ZERO 3
#define WRAP_ONE 4

#define TEXTURE_FIELDS(F)                                                             \
  F(int, kind)     /* TEXTURE_* */                                                    \
  F(float, u_by_u) /* the texture's coordinates: u_by_u u + u_by_v v + u_offset */    \
  F(float, u_by_v)                                                                    \
  F(float, u_offset)                                                                  \
  F(float, v_by_u) /* ... and v_by_u u + v_by_v v + v_offset */                       \
  F(float, v_by_v)                                                                    \
  F(float, v_offset)                                                                  \
  F(vec3, colour0)                                                                    \
  F(vec3, colour1)                                                                    \
  F(int, texture0) /* texture (a lower index), or -1: scales colour0, or the texel */ \
  F(int, texture1) /* ... colour1 */                                                  \
  /* Bitmaps: see bitmap_texture.h. */                                                \
  F(int, width)                                                                       \
  F(int, height)                                                                      \
  F(int, channels) /* 1 or 3 */                                                       \
  F(int, texels)   /* first word in the table of texels; the first row is at v = 0 */ \
  F(int, decoding) /* first word of its table of decoded values, or -1: none */       \
  F(int, wrap_u)   /* WRAP_* */                                                       \
  F(int, wrap_v)                                                                      \
  F(int, nearest) /* 1: nearest texel, 0: bilinear */                                 \
  /* Noise: see noise_texture.h. */                                                   \
  F(uint, seed)                                                                       \
  F(int, octaves)                                                                     \
  F(float, persistence)                                                               \
  F(float, lacunarity)                                                                \
  /* Colours of meshes: index among those of a triangle. */                           \
  F(int, attribute)

PENUMBRA_NAMESPACE_END
#endif
