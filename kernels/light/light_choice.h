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

/// Takes the light of that index, one of whose numbers u is: what is left of it for a point on the light.
FN ChosenLight take_light(const PRIVATE Scene* scene, int light, float u, float fine) {
  ChosenLight choice;
  choice.light = light;
  choice.pmf = scene->lights[light].pmf;
  const int number = (int)(u * LIGHT_NUMBERS) - scene->lights[light].start;
  const float left = ((float)number + fine) / (choice.pmf > 0.0f ? choice.pmf * LIGHT_NUMBERS : 1.0f);
  choice.u = clamp_f(left, 0.0f, ONE_MINUS_EPSILON);
  return choice;
}

/// By power, and u, a multiple of 2^-24: by its cell in a table of 2^k. A light's cells are neighbours, and
/// neighbours in space are near each other in the table, so numbers that are well spread give points that are
/// well spread on each light, and over lights that are parts of one light. `fine` in [0, 1) are the digits
/// below, of which a light that is rarely chosen leaves few.
FN ChosenLight choose_light(const PRIVATE Scene* scene, float u, float fine) {
  return take_light(scene, scene->light_cells[(int)(u * (float)scene->header.tables.light_cells.count)], u,
                    fine);
}

PENUMBRA_NAMESPACE_END
#endif
