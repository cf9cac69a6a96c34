// Another texture, times a colour: `scale` of Mitsuba 0.6.
#ifndef PENUMBRA_SCALE_TEXTURE_H
#define PENUMBRA_SCALE_TEXTURE_H
#include "kernels/texture/texture_step.h"

PENUMBRA_NAMESPACE_BEGIN

FN TextureStep scale_texture(const PRIVATE Scene* scene, GLOBAL const TextureNode* texture, TexturePlace at) {
  TextureStep step;
  step.factor = load3(&texture->colour0);
  step.next = texture->texture0;
  return step;
}

PENUMBRA_NAMESPACE_END
#endif
