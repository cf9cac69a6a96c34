// One step of evaluating a texture: a factor, and the next texture, whose value it multiplies. So nested
// textures are evaluated in a loop, without recursion.
#ifndef PENUMBRA_TEXTURE_STEP_H
#define PENUMBRA_TEXTURE_STEP_H
#include "kernels/intersect/surface_fields.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 factor;
  int next;  ///< index of the next texture, or -1: the factor is the value
} TextureStep;

/// The point where a texture is evaluated.
typedef struct {
  float u, v;     ///< the texture's own coordinates, after its transform
  vec3 p;         ///< of the surface
  int primitive;  ///< the surface's primitive
} TexturePlace;

FN TexturePlace texture_place(GLOBAL const TextureNode* texture, Surface s) {
  TexturePlace at;
  at.u = (texture->u_by_u * s.u + texture->u_by_v * s.v) + texture->u_offset;
  at.v = (texture->v_by_u * s.u + texture->v_by_v * s.v) + texture->v_offset;
  at.p = s.p;
  at.primitive = s.primitive;
  return at;
}

PENUMBRA_NAMESPACE_END
#endif
