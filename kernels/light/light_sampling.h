// The result of the light sampling stage, which precedes an integrator's step. The stage takes many times the
// arithmetic of the step, so it is separate: scenes that do not need it do not pay for it.
#ifndef PENUMBRA_LIGHT_SAMPLING_H
#define PENUMBRA_LIGHT_SAMPLING_H
#include "kernels/features.h"
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

/// A light sample as far as the stage decides it. Densities by projected solid angle do not include the
/// probability of choosing the light.
typedef struct {
  float found_pdf;  ///< density with which the last ray's direction would have been sampled, or negative
  float light;      ///< index of the light that the step samples; negative: the step chooses by power
  float pmf;        ///< probability of choosing it
  vec3 wi;          ///< direction towards it
  float scale;      ///< the density of wi is its cosine times this; negative: the step samples a point
} LightSampling;

enum {
  LIGHT_SAMPLING_FOUND_PDF,
  LIGHT_SAMPLING_LIGHT,
  LIGHT_SAMPLING_PMF,
  LIGHT_SAMPLING_X,
  LIGHT_SAMPLING_Y,
  LIGHT_SAMPLING_Z,
  LIGHT_SAMPLING_SCALE,
  LIGHT_SAMPLING_COUNT
};
#define HAS_LIGHT_SAMPLING (HAS(PROJECTED) || HAS(POLYGONS))
// Floats of a PRIVATE array that holds LANES of LightSampling, value V of lane j at V * LANES + j.
#define LIGHT_SAMPLING_FLOATS (HAS_LIGHT_SAMPLING ? LIGHT_SAMPLING_COUNT * LANES : 1)

FN LightSampling no_light_sampling(void) {
  LightSampling sampling;
  sampling.found_pdf = sampling.light = sampling.scale = -1.0f;
  sampling.pmf = 0.0f;
  sampling.wi = make_vec3(0.0f, 0.0f, 1.0f);
  return sampling;
}

FN void store_light_sampling(PRIVATE float* samplings, int j, LightSampling sampling) {
#if HAS_LIGHT_SAMPLING
  samplings[LIGHT_SAMPLING_FOUND_PDF * LANES + j] = sampling.found_pdf;
  samplings[LIGHT_SAMPLING_LIGHT * LANES + j] = sampling.light;
  samplings[LIGHT_SAMPLING_PMF * LANES + j] = sampling.pmf;
  samplings[LIGHT_SAMPLING_X * LANES + j] = sampling.wi.x;
  samplings[LIGHT_SAMPLING_Y * LANES + j] = sampling.wi.y;
  samplings[LIGHT_SAMPLING_Z * LANES + j] = sampling.wi.z;
  samplings[LIGHT_SAMPLING_SCALE * LANES + j] = sampling.scale;
#endif
}

/// Lane j's; no_light_sampling() in kernels that are compiled without.
FN LightSampling load_light_sampling(const PRIVATE float* samplings, int j) {
  LightSampling sampling = no_light_sampling();
#if HAS_LIGHT_SAMPLING
  sampling.found_pdf = samplings[LIGHT_SAMPLING_FOUND_PDF * LANES + j];
  sampling.light = samplings[LIGHT_SAMPLING_LIGHT * LANES + j];
  sampling.pmf = samplings[LIGHT_SAMPLING_PMF * LANES + j];
  sampling.wi = make_vec3(samplings[LIGHT_SAMPLING_X * LANES + j], samplings[LIGHT_SAMPLING_Y * LANES + j],
                          samplings[LIGHT_SAMPLING_Z * LANES + j]);
  sampling.scale = samplings[LIGHT_SAMPLING_SCALE * LANES + j];
#endif
  return sampling;
}

PENUMBRA_NAMESPACE_END
#endif
