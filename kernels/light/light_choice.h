// Chooses one of the scene's lights by power.
#ifndef PENUMBRA_LIGHT_CHOICE_H
#define PENUMBRA_LIGHT_CHOICE_H
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  int light;
  float u;    ///< remainder of the number that chose it, again uniform in [0, 1)
  float pmf;  ///< probability of the choice
} ChosenLight;

/// Takes light `light`, which u selects. The remainder of u samples a point on it.
FN ChosenLight take_light(const PRIVATE Scene* scene, int light, float u, float fine) {
  ChosenLight choice;
  choice.light = light;
  choice.pmf = scene->lights[light].pmf;
  const int number = (int)(u * LIGHT_PROBABILITY_STEPS) - scene->lights[light].start;
  const float left =
      ((float)number + fine) / (choice.pmf > 0.0f ? choice.pmf * LIGHT_PROBABILITY_STEPS : 1.0f);
  choice.u = clamp_f(left, 0.0f, ONE_MINUS_EPSILON);
  return choice;
}

/// Chooses a light by power and u, a multiple of 2^-24, through its cell in a table of 2^k. A light's cells
/// are consecutive, and lights that are near each other in space are near each other in the table. So
/// stratified numbers give stratified points on each light, and over lights that are parts of one light.
/// `fine`, in [0, 1), has the digits below those of u; a light that is rarely chosen leaves few digits of u.
FN ChosenLight choose_light(const PRIVATE Scene* scene, float u, float fine) {
  return take_light(scene, scene->light_cells[(int)(u * (float)scene->header.tables.light_cells.count)], u,
                    fine);
}

PENUMBRA_NAMESPACE_END
#endif
