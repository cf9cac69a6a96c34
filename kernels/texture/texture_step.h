// What one texture makes of a point: a factor, and the texture whose value it multiplies. So textures that
// hold others are walks from one to the next, without recursion.
#ifndef PENUMBRA_TEXTURE_STEP_H
#define PENUMBRA_TEXTURE_STEP_H
#include "kernels/math/lane_record.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 factor;
  int next;  ///< index of the other texture, or -1: the factor is the value
} TextureStep;

/// Coordinates of a point on a texture, its transform applied.
typedef struct {
  float u, v;
} TextureCoordinates;

FN TextureCoordinates texture_coordinates(GLOBAL const TextureNode* texture, float u, float v) {
  TextureCoordinates at;
  at.u = (texture->u_by_u * u + texture->u_by_v * v) + texture->u_offset;
  at.v = (texture->v_by_u * u + texture->v_by_v * v) + texture->v_offset;
  return at;
}

PENUMBRA_NAMESPACE_END
#endif
