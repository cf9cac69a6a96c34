// A checkerboard with 2 x 2 squares in each unit square of texture coordinates: colour0 where the fractional
// parts of u and v are both above 1/2 or both at most 1/2, as in Mitsuba 3.
#ifndef PENUMBRA_CHECKERBOARD_TEXTURE_H
#define PENUMBRA_CHECKERBOARD_TEXTURE_H
#include "kernels/texture/texture_step.h"

PENUMBRA_NAMESPACE_BEGIN

FN TextureStep checkerboard_texture(const PRIVATE Scene* scene, GLOBAL const TextureNode* texture,
                                    TexturePlace at) {
  const float u = at.u - floor_f(at.u), v = at.v - floor_f(at.v);
  const bool first = (u > 0.5f) == (v > 0.5f);
  const vec3 colour0 = load3(&texture->colour0), colour1 = load3(&texture->colour1);
  const int texture0 = texture->texture0, texture1 = texture->texture1;
  TextureStep step;
  step.factor = select3(first, colour0, colour1);
  step.next = first ? texture0 : texture1;
  return step;
}

PENUMBRA_NAMESPACE_END
#endif
