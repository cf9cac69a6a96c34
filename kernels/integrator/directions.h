// Directions that an integrator samples itself, about the shading normal, instead of sampling the BSDFs.
#ifndef PENUMBRA_DIRECTIONS_H
#define PENUMBRA_DIRECTIONS_H
#include "kernels/integrator/step.h"

PENUMBRA_NAMESPACE_BEGIN

/// The pdf, per solid angle, of the scene's direction sampling (DIRECTION_*) about the shading normal n.
FN float direction_pdf(int kind, vec3 n, vec3 wi, float bsdf_pdf) {
  const float cosine = max_f(dot3(n, wi), 0.0f);
  const float pdf = kind == DIRECTION_COSINE ? cosine * INV_PI_F : (cosine > 0.0f ? 0.5f * INV_PI_F : 0.0f);
  return kind == DIRECTION_BSDF ? bsdf_pdf : pdf;
}

/// The BSDF families that are always sampled by themselves, because directions of the hemisphere would miss
/// some of their light.
FN ulong families_with_own_directions(const PRIVATE SceneHeader* h) {
  return h->integrator.bsdf_sampling == DIRECTION_BSDF ? ~(ulong)0
                                                       : families_with(DELTA | SOME_DELTA | TRANSMITS);
}

STAGE void direction_samples(int kind, const PRIVATE Surfaces* RESTRICT surfaces,
                             const PRIVATE float* RESTRICT uv, PRIVATE float* RESTRICT wi) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 n = LOAD_LANE_vec3(surfaces->shading, j);
      const vec3 by_cosine = sample_cosine_hemisphere(n, uv[j], uv[LANES + j]);
      const vec3 by_area = sample_uniform_hemisphere(n, uv[j], uv[LANES + j]);
      STORE_LANE_vec3(wi, j, select3(kind == DIRECTION_COSINE, by_cosine, by_area));
    }
}

STAGE void weigh_directions(int kind, const PRIVATE Surfaces* RESTRICT surfaces,
                            const PRIVATE float* RESTRICT wi, const PRIVATE BsdfValues* RESTRICT values,
                            PRIVATE BsdfSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const BsdfValue value = load_bsdf_value(values, j);
      BsdfSample s = no_bsdf_sample();
      s.wi = LOAD_LANE_vec3(wi, j);
      const float pdf = direction_pdf(kind, LOAD_LANE_vec3(surfaces->shading, j), s.wi, value.pdf);
      s.pdf = value.pdf > 0.0f ? pdf : 0.0f;
      s.weight = scale(value.f_cos, 1.0f / (pdf > 0.0f ? pdf : 1.0f));
      store_bsdf_sample(samples, j, s);
    }
}

/// Replaces the samples by the `chosen` hemisphere samples where the closure is in none of these families.
STAGE void take_chosen(const PRIVATE Closures* RESTRICT closures, ulong by_themselves,
                       const PRIVATE BsdfSamples* RESTRICT chosen, PRIVATE BsdfSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool own = is_among(load_closure(closures, j), by_themselves);
      store_bsdf_sample(samples, j,
                        select_bsdf_sample(own, load_bsdf_sample(samples, j), load_bsdf_sample(chosen, j)));
    }
}

/// Samples directions about the hemisphere, and evaluates closures of these families for them, as BSDF
/// samples.
FN void choose_directions(const PRIVATE Scene* scene, ulong families, const PRIVATE StepLanes* step,
                          PRIVATE BsdfSamples* samples) {
  const PRIVATE SceneHeader* h = &scene->header;
  float wi[3 * LANES];
  BsdfValues values;
  direction_samples(h->integrator.bsdf_sampling, &step->surfaces, step->u + DIM_BSDF_U * LANES, wi);
  eval_bsdfs(scene, families, &step->closures, &step->surfaces, wi, &values);
  weigh_directions(h->integrator.bsdf_sampling, &step->surfaces, wi, &values, samples);
}

/// Samples directions by the BSDFs or about the hemisphere, whichever the scene wants.
FN void sample_directions(const PRIVATE Scene* scene, PRIVATE StepLanes* step) {
  const ulong by_themselves = families_with_own_directions(&scene->header);
  sample_bsdfs(scene, step->families & by_themselves, &step->closures, &step->surfaces,
               step->u + DIM_BSDF_U * LANES, step->u + DIM_LOBE_CHOICE * LANES, &step->samples);
  if ((step->families & ~by_themselves) != 0u) {
    BsdfSamples others;
    choose_directions(scene, step->families & ~by_themselves, step, &others);
    take_chosen(&step->closures, by_themselves, &others, &step->samples);
  }
  shade_bumps(scene, &step->surfaces, &step->samples);
}

PENUMBRA_NAMESPACE_END
#endif
