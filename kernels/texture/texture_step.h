// What one texture makes of a point: a factor, and the texture whose value it multiplies. So textures that
// hold others are walks from one to the next, without recursion.
#ifndef PENUMBRA_TEXTURE_STEP_H
#define PENUMBRA_TEXTURE_STEP_H
#include "kernels/intersect/surface_fields.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 factor;
  int next;  ///< index of the other texture, or -1: the factor is the value
} TextureStep;

/// Where a texture is evaluated.
typedef struct {
  float u, v;     ///< its own coordinates: its transform is applied
  vec3 p;         ///< of the surface
  int primitive;  ///< that the surface is on
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
