// The result of the light sampling stage, which precedes an integrator's step. The stage is separate because
// it costs many times as much arithmetic as the step; scenes that do not need it skip it.
#ifndef PENUMBRA_LIGHT_SAMPLING_H
#define PENUMBRA_LIGHT_SAMPLING_H
#include "kernels/light/light_receiver.h"

PENUMBRA_NAMESPACE_BEGIN

// The part of a light sample that the stage decides. Pdfs by projected solid angle do not include the
// probability of choosing the light.
#define LIGHT_SAMPLING_FIELDS(F, a)                                                              \
  F(a, int, light)   /* index of the light to sample; negative: the step chooses one by power */ \
  F(a, float, pmf)   /* probability of choosing the light */                                     \
  F(a, vec3, wi)     /* direction towards the light */                                           \
  F(a, float, scale) /* pdf of wi over its cosine; negative: the step samples a point */         \
  /* For an environment map, once its cell is chosen: */                                         \
  F(a, int, column)                                                                              \
  F(a, int, row)                                                                                 \
  F(a, float, between) /* position between that row and the next */
LANE_RECORD(LightSampling, LightSamplings, light_sampling, LIGHT_SAMPLING_FIELDS)

FN LightSampling no_light_sampling(void) {
  LightSampling sampling;
  sampling.scale = -1.0f;
  sampling.light = -1;
  sampling.pmf = 0.0f;
  sampling.wi = make_vec3(0.0f, 0.0f, 1.0f);
  sampling.column = sampling.row = 0;
  sampling.between = 0.0f;
  return sampling;
}

STAGE void clear_light_samplings(PRIVATE LightSamplings* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_light_sampling(samplings, j, no_light_sampling());
}

PENUMBRA_NAMESPACE_END
#endif
