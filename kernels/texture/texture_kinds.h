// The kinds of textures: their numbers, and the record of one.
#ifndef PENUMBRA_TEXTURE_KINDS_H
#define PENUMBRA_TEXTURE_KINDS_H
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

// X(name, NAME, number, what it is for people). What a kind is stands in <name>_texture.h, which texture.h
// includes: one function, <name>_texture.
#define TEXTURE_KINDS(X) X(checkerboard, CHECKERBOARD, 0, "checkerboards")

#define ENUMERATE_KIND(name, NAME, number, description) TEXTURE_##NAME = number,
#define COUNT_KIND(name, NAME, number, description) +1
enum { TEXTURE_KINDS(ENUMERATE_KIND) TEXTURE_KIND_COUNT = 0 TEXTURE_KINDS(COUNT_KIND) };
#undef ENUMERATE_KIND
#undef COUNT_KIND

#define TEXTURE_FIELDS(F)                                                                      \
  F(int, kind)     /* TEXTURE_* */                                                             \
  F(float, u_by_u) /* its own coordinates: u_by_u u + u_by_v v + u_offset ... */               \
  F(float, u_by_v)                                                                             \
  F(float, u_offset)                                                                           \
  F(float, v_by_u) /* ... and v_by_u u + v_by_v v + v_offset */                                \
  F(float, v_by_v)                                                                             \
  F(float, v_offset)                                                                           \
  F(vec3, colour0)                                                                             \
  F(vec3, colour1)                                                                             \
  F(int, texture0) /* by which colour0 is multiplied, or -1; it has a lower index than this */ \
  F(int, texture1) /* ... colour1 */

PENUMBRA_NAMESPACE_END
#endif
