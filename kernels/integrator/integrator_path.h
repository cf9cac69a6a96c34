// Path tracing with next-event estimation, as a step function: given the hit of a path's last ray, add what
// it found and ask for at most one shadow ray and one next ray. It never traces.
#ifndef PENUMBRA_INTEGRATOR_PATH_H
#define PENUMBRA_INTEGRATOR_PATH_H
#include "kernels/block/shadow_ray.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/light/light.h"
#include "kernels/light/mis.h"
#include "kernels/sampler/sampler.h"

PENUMBRA_NAMESPACE_BEGIN

// Russian roulette: see roulette_survival.
#define ROULETTE_LASTS 100.0f

/// Probability of going on after the k-th throw, k = 0, 1 ... Paths that carry little end sooner, but later
/// than their throughput asks for, which costs some steps and saves more variance: sqrt(2 t) was the best of
/// t, sqrt t, 2 t, 4 t, the fourth root of t, mean and luminance. The cap ends paths that lose nothing, where
/// albedo is 1: n throws are survived with at most (100 / n)^2, so weights grow like n^2 and no faster, which
/// any albedo below 1 outweighs. A constant cap has infinite variance beyond albedo sqrt(cap).
FN float roulette_survival(float throughput, int k) {
  return min_f(SQRT(2.0f * throughput), 1.0f - 2.0f / ((float)k + ROULETTE_LASTS));
}

/// Lane i of the block after `step` earlier steps, whose last ray hit `s`; u holds STEP_DIMENSIONS * LANES
/// numbers, those of lane i at j.
FN void path_step(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                  int capacity, int step, int i, const PRIVATE float* u, int j, Surface s, Emission emission,
                  LightSample light) {
  const int sampling = scene->header.direct_sampling;
  vec3 throughput = LOAD3(f, capacity, THROUGHPUT_X, i);
  const float direction_pdf = f[DIRECTION_PDF * capacity + i];
  const int primitive = ints[HIT * capacity + i];

  const float bsdf_weight = sampling == SAMPLING_MIS
                                ? mis_weight(scene->header.heuristic, direction_pdf, emission.pdf)
                                : (sampling == SAMPLING_BSDF_ONLY ? 1.0f : 0.0f);
  const float seen = scene->header.hide_emitters != HIDE_NOTHING ? 0.0f : 1.0f;
  // Where the closed form of a light is added at every surface, only next-event estimation samples that
  // light.
  const bool controlled = (scene->header.estimator != ESTIMATOR_SAMPLES) & emission.of_polygon;
  const float emission_weight = step > 0 ? (controlled ? 0.0f : bsdf_weight) : seen;
  const vec3 radiance = LOAD3(f, capacity, RADIANCE_X, i);
  const vec3 found = add(radiance, mul(throughput, scale(emission.radiance, emission_weight)));
  STORE3(f, capacity, RADIANCE_X, i, found);

  GLOBAL const Material* material = scene->materials + s.material;
  const bool scatters = s.valid & (step + 1 < scene->header.max_depth);

  const BsdfValue value = eval_bsdf(material, s.shading, s.wo, light.wi);
  const float shared =
      sampling == SAMPLING_MIS ? mis_weight(scene->header.heuristic, light.pdf, value.pdf) : 1.0f;
  const bool alone = light.delta | ((scene->header.estimator != ESTIMATOR_SAMPLES) & light.of_polygon);
  const float light_weight = (alone ? 1.0f : shared) / (light.pdf > 0.0f ? light.pdf : 1.0f);
  const bool lit =
      scatters & (light.tmax > 0.0f) & (value.pdf > 0.0f) & ((sampling != SAMPLING_BSDF_ONLY) | light.delta);
  const vec3 arriving = mul(throughput, scale(mul(value.f_cos, light.radiance), light_weight));
  ask_for_shadow_ray(scene, f, ints, capacity, i, s, light, arriving, lit, primitive);

  const BsdfSample next = sample_bsdf(material, s.shading, s.wo, u[DIM_BSDF_U * LANES + j],
                                      u[DIM_BSDF_V * LANES + j], u[DIM_LOBE_CHOICE * LANES + j]);
  throughput = mul(throughput, next.weight);
  const float strongest = max_component(throughput);
  const bool roulette = step + 1 >= scene->header.rr_depth;
  const int throws = roulette ? step + 1 - scene->header.rr_depth : 0;
  const float survival = roulette ? roulette_survival(strongest, throws) : 1.0f;
  const bool alive = scatters & (next.pdf > 0.0f) & (strongest > 0.0f) & !is_beneath(s, next.wi) &
                     (u[DIM_ROULETTE * LANES + j] < survival);
  throughput = scale(throughput, 1.0f / (alive ? survival : 1.0f));
  const vec3 origin = leave_surface(s.p, s.geometric, s.error, next.wi);
  STORE3(f, capacity, RAY_ORIGIN_X, i, origin);
  STORE3(f, capacity, RAY_DIRECTION_X, i, next.wi);
  STORE3(f, capacity, THROUGHPUT_X, i, throughput);
  f[RAY_TMAX * capacity + i] = NO_LIMIT;
  f[DIRECTION_PDF * capacity + i] = next.pdf;
  ints[RAY_SKIP * capacity + i] = primitive;
  ints[ALIVE * capacity + i] = alive ? 1 : 0;
}

PENUMBRA_NAMESPACE_END
#endif
