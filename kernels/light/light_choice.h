// Choosing one of the scene's lights.
#ifndef PENUMBRA_LIGHT_CHOICE_H
#define PENUMBRA_LIGHT_CHOICE_H
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  int light;
  float u;    ///< what is left of the number that chose it, uniform in [0, 1) again
  float pmf;  ///< probability of the choice
} ChosenLight;

/// Takes the light of that index: what is left of u for a point on it. `rank` is to be added to the number's
/// index for its rank among those of this light.
FN ChosenLight take_light(const PRIVATE Scene* scene, int light, int rank, float u, float fine) {
  ChosenLight choice;
  choice.light = light;
  choice.pmf = scene->lights[light].pmf;
  const float left =
      ((float)((int)(u * 16777216.0f) + rank) + fine) / (choice.pmf > 0.0f ? choice.pmf * 16777216.0f : 1.0f);
  choice.u = clamp_f(left, 0.0f, ONE_MINUS_EPSILON);
  return choice;
}

/// Walker's alias method by u, a multiple of 2^-24. The numbers that choose a light are spread out over
/// [0, 1) by their rank among them: so numbers that are well spread give well spread points on each light.
/// `fine` in [0, 1) are the digits below, of which a light that is rarely chosen leaves few.
FN ChosenLight choose_light(const PRIVATE Scene* scene, float u, float fine) {
  const int count = scene->header.tables.lights.count;
  const float position = u * (float)count;
  const int first = min_i((int)position, count > 0 ? count - 1 : 0);
  GLOBAL const Light* place = scene->lights + first;
  const float threshold = place->alias_threshold;
  const int alias = place->alias, own_rank = place->rank,
            alias_rank = place->alias_rank;  // no conditional loads
  const bool own = position - (float)first < threshold;
  return take_light(scene, own ? first : alias, own ? own_rank : alias_rank, u, fine);
}

PENUMBRA_NAMESPACE_END
#endif
