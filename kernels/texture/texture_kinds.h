// The kinds of textures: their numbers, and the record of one.
#ifndef PENUMBRA_TEXTURE_KINDS_H
#define PENUMBRA_TEXTURE_KINDS_H
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

// X(name, NAME, number, what it is for people). What a kind is stands in <name>_texture.h, which texture.h
// includes: one function, <name>_texture.
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
// Bits 1 << TEXTURE_*. OpenCL kernels are compiled with exactly a scene's kinds, native code with all: a kind
// that the scene lacks is not called.
#ifndef TEXTURE_KINDS_MASK
  #define TEXTURE_KINDS_MASK ALL_TEXTURE_KINDS
#endif

#define LEAST_TEXELS 3  // words that kernels read whatever the textures

#define MAX_NOISE_OCTAVES 10

// What a bitmap is beyond its edges.
#define WRAP_REPEAT 0
#define WRAP_MIRROR 1
#define WRAP_CLAMP 2
#define WRAP_ZERO 3
#define WRAP_ONE 4

#define TEXTURE_FIELDS(F)                                                                       \
  F(int, kind)     /* TEXTURE_* */                                                              \
  F(float, u_by_u) /* its own coordinates: u_by_u u + u_by_v v + u_offset ... */                \
  F(float, u_by_v)                                                                              \
  F(float, u_offset)                                                                            \
  F(float, v_by_u) /* ... and v_by_u u + v_by_v v + v_offset */                                 \
  F(float, v_by_v)                                                                              \
  F(float, v_offset)                                                                            \
  F(vec3, colour0)                                                                              \
  F(vec3, colour1)                                                                              \
  F(int, texture0) /* by which colour0 is multiplied, or -1; it has a lower index than this */  \
  F(int, texture1) /* ... colour1 */                                                            \
  /* Bitmaps: see texel.h. */                                                                   \
  F(int, width)                                                                                 \
  F(int, height)                                                                                \
  F(int, channels) /* 1 or 3 */                                                                 \
  F(int, texels)   /* first word of the first row, which is at v = 0, in the table of texels */ \
  F(int, decoding) /* word where its table of decoded values begins, or -1: none */             \
  F(int, wrap_u)   /* WRAP_* */                                                                 \
  F(int, wrap_v)                                                                                \
  F(int, nearest) /* 1: the nearest texel alone, 0: bilinear */                                 \
  /* Noise: see noise_texture.h. */                                                             \
  F(uint, seed)                                                                                 \
  F(int, octaves)                                                                               \
  F(float, persistence)                                                                         \
  F(float, lacunarity)                                                                          \
  /* Colours of meshes: which of a triangle's. */                                               \
  F(int, attribute)

PENUMBRA_NAMESPACE_END
#endif
