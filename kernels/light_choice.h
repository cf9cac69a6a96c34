// Choosing one of the scene's lights.
#ifndef PENUMBRA_LIGHT_CHOICE_H
#define PENUMBRA_LIGHT_CHOICE_H
#include "kernels/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Walker's alias method: which light `u` chooses.
FN int choose_light(const PRIVATE Scene* scene, float u) {
  const int count = scene->header.light_count;
  const float position = u * (float)count;
  const int first = min_i((int)position, count > 0 ? count - 1 : 0);
  GLOBAL const Light* light = scene->lights + first;
  const float threshold = light->alias_threshold;
  const int alias = light->alias;  // read always: a conditional load would not vectorise
  return position - (float)first < threshold ? first : alias;
}

PENUMBRA_NAMESPACE_END
#endif
