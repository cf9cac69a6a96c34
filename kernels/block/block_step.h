// The stages of a block that step its paths by an integrator.
#ifndef PENUMBRA_BLOCK_STEP_H
#define PENUMBRA_BLOCK_STEP_H
#include "kernels/block/block_light_sampling.h"
#include "kernels/integrator/integrator_direct.h"
#include "kernels/integrator/integrator_path.h"

PENUMBRA_NAMESPACE_BEGIN

/// Random numbers for a step of LANES paths from lane i on; those that the step does not need are not
/// written.
FN void step_numbers(const PRIVATE SceneHeader* h, uint pair, bool roulette, const GLOBAL int* RESTRICT ints,
                     int capacity, int i, PRIVATE float* RESTRICT u) {
  const uint spp = sequence_length(h);
  sample_pair(h->sampler.kind, spp, one_point(pair), ints, capacity, i, u + DIM_LIGHT_U * LANES,
              u + DIM_LIGHT_V * LANES);
  sample_pair(h->sampler.kind, spp, one_point(pair + 1u), ints, capacity, i, u + DIM_BSDF_U * LANES,
              u + DIM_BSDF_V * LANES);
  const bool chooses = h->tables.lights.count > 1;  // a single light needs no finer digits
  if (chooses | HAS(PHONG))
    sample_pair(h->sampler.kind, spp, one_point(pair + 2u), ints, capacity, i,
                u + (chooses ? DIM_LIGHT_FINE : DIM_SPARE) * LANES, u + DIM_LOBE_CHOICE * LANES);
  if (roulette)
    sample_pair(h->sampler.kind, spp, one_point(pair + 3u), ints, capacity, i, u + DIM_ROULETTE * LANES,
                u + DIM_SPARE * LANES);
}

#if HAS(PATH)
STAGE void step_paths(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                      int capacity, int count, int step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const uint pair = step_pair(step);
  const bool roulette = step + 1 >= h->integrator.rr_depth, scatters = step + 1 < h->integrator.max_depth;
  const LightRequest request =
      light_request(scene, true, scatters, scatters, h->integrator.direct_sampling == SAMPLING_MIS);
  SurfaceFields surface;
  surface.hit = HIT;
  surface.origin_x = RAY_ORIGIN_X;
  surface.direction_x = RAY_DIRECTION_X;
  float u[STEP_DIMENSIONS * LANES];
  for (int j = 0; j < STEP_DIMENSIONS * LANES; j++) u[j] = 0.0f;
  for (int i = 0; i < count; i += LANES) {
    if (scatters) step_numbers(h, pair, roulette, ints, capacity, i, u);
    float samplings[LIGHT_SAMPLING_FLOATS];
    sample_light_lanes(scene, request, surface, f, ints, capacity, i, u, samplings);
    LANE_LOOP
      for (int j = 0; j < LANES; j++) path_step(scene, f, ints, capacity, step, i + j, u, j, samplings);
  }
}
#endif

#if HAS(DIRECT)
STAGE void keep_camera_rays(GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints, int capacity, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) keep_camera_ray(f, ints, capacity, j);
  }
}

// One stage each, so that what a scene does not need is not computed.

STAGE void see_emitters(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                        int capacity, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) see_emitter(scene, f, ints, capacity, j);
}

STAGE void weigh_emitters(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                          int capacity, int i, const PRIVATE float* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      weigh_emitter(scene, f, ints, capacity, i + j, load_light_sampling(samplings, j));
}

STAGE void sample_emitters(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                           int capacity, int i, const PRIVATE float* RESTRICT u,
                           const PRIVATE float* RESTRICT samplings) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      sample_emitter(scene, f, ints, capacity, i + j, u, j, load_light_sampling(samplings, j));
}

STAGE void sample_directions(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                             int capacity, int i, const PRIVATE float* RESTRICT u) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) sample_direction(scene, f, ints, capacity, i + j, u, j);
}

STAGE void begin_steps(GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints, int capacity, bool is_last,
                       int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) begin_step(f, ints, capacity, is_last, j);
}

/// Random numbers for a step's light and direction samples.
FN void direct_numbers(const PRIVATE SceneHeader* h, int step, const GLOBAL int* RESTRICT ints, int capacity,
                       int i, PRIVATE float* RESTRICT u) {
  const uint spp = sequence_length(h), pair = step_pair(0);
  const int emitter_samples = h->integrator.emitter_samples, bsdf_samples = h->integrator.bsdf_samples;
  const int most = emitter_samples > bsdf_samples ? emitter_samples : bsdf_samples;
  if (step < emitter_samples)
    sample_pair(h->sampler.kind, spp, nth_point(pair, emitter_samples, step), ints, capacity, i,
                u + DIM_LIGHT_U * LANES, u + DIM_LIGHT_V * LANES);
  if (step < bsdf_samples)
    sample_pair(h->sampler.kind, spp, nth_point(pair + 1u, bsdf_samples, step), ints, capacity, i,
                u + DIM_BSDF_U * LANES, u + DIM_BSDF_V * LANES);
  if ((step < bsdf_samples) | ((step < emitter_samples) & (h->tables.lights.count > 1)))
    sample_pair(h->sampler.kind, spp, nth_point(pair + 2u, most, step), ints, capacity, i,
                u + DIM_LIGHT_FINE * LANES, u + DIM_LOBE_CHOICE * LANES);
}

STAGE void step_direct(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                       int capacity, int count, int step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const bool emits = step < h->integrator.emitter_samples, scatters = step < h->integrator.bsdf_samples;
  const bool balances = h->integrator.bsdf_samples > 0;
  const int rays = balances ? h->integrator.bsdf_samples + 1 : 1;
  const bool is_last =
      step + 1 >= (h->integrator.emitter_samples > rays ? h->integrator.emitter_samples : rays);
  const LightRequest request = light_request(scene, false, emits, step == 0, balances);
  SurfaceFields surface;
  surface.hit = CAMERA_HIT;
  surface.origin_x = CAMERA_ORIGIN_X;
  surface.direction_x = CAMERA_DIRECTION_X;
  float u[STEP_DIMENSIONS * LANES];
  for (int j = 0; j < STEP_DIMENSIONS * LANES; j++) u[j] = 0.0f;
  for (int i = 0; i < count; i += LANES) {
    direct_numbers(h, step, ints, capacity, i, u);
    float samplings[LIGHT_SAMPLING_FLOATS];
    sample_light_lanes(scene, request, surface, f, ints, capacity, i, u, samplings);
    if (balances) weigh_emitters(scene, f, ints, capacity, i, samplings);
    if (!balances & (step == 0)) see_emitters(scene, f, ints, capacity, i);
    begin_steps(f, ints, capacity, is_last, i);
    if (emits) sample_emitters(scene, f, ints, capacity, i, u, samplings);
    if (scatters) sample_directions(scene, f, ints, capacity, i, u);
  }
}
#endif

PENUMBRA_NAMESPACE_END
#endif
