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
  sample_pair(h->sampler, spp, one_point(pair), ints, capacity, i, u + DIM_LIGHT_U * LANES,
              u + DIM_LIGHT_V * LANES);
  sample_pair(h->sampler, spp, one_point(pair + 1u), ints, capacity, i, u + DIM_BSDF_U * LANES,
              u + DIM_BSDF_V * LANES);
  const bool chooses = h->light_count > 1;  // a single light needs no finer digits
  if (chooses | HAS(PHONG))
    sample_pair(h->sampler, spp, one_point(pair + 2u), ints, capacity, i,
                u + (chooses ? DIM_LIGHT_FINE : DIM_SPARE) * LANES, u + DIM_LOBE_CHOICE * LANES);
  if (roulette)
    sample_pair(h->sampler, spp, one_point(pair + 3u), ints, capacity, i, u + DIM_ROULETTE * LANES,
                u + DIM_SPARE * LANES);
}

/// The surfaces that the rays of LANES paths from lane i on hit, kept in those fields, and what they found of
/// lights there.
STAGE void find_surfaces(const PRIVATE Scene* scene, SurfaceFields at, const GLOBAL float* RESTRICT f,
                         const GLOBAL int* RESTRICT ints, int capacity, int i,
                         PRIVATE Surfaces* RESTRICT surfaces, PRIVATE LightReceivers* RESTRICT receivers,
                         PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 from = LOAD3(f, capacity, at.origin_x, i + j);
      const vec3 toward = LOAD3(f, capacity, at.direction_x, i + j);
      const Surface s = surface_at(scene, ints[at.hit * capacity + i + j], from, toward);
      store_surface(surfaces, j, s);
      store_receiver(receivers, j, receiver_of(s));
      store_found_light(scene, s, from, found, j);
    }
}

#if HAS(PATH)
STAGE void scatter_paths(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                         int capacity, int step, int i, const PRIVATE float* RESTRICT u,
                         const PRIVATE Surfaces* RESTRICT surfaces,
                         const PRIVATE Emissions* RESTRICT emissions,
                         const PRIVATE LightSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      path_step(scene, f, ints, capacity, step, i + j, u, j, load_surface(surfaces, j),
                load_emission(emissions, j), load_light_sample(samples, j));
}

STAGE void step_paths(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                      int capacity, int count, int step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const uint pair = step_pair(step);
  const bool roulette = step + 1 >= h->rr_depth, scatters = step + 1 < h->max_depth;
  const bool balances = h->direct_sampling == SAMPLING_MIS;
  const LightRequest request = light_request(scene, true, scatters, scatters, balances);
  SurfaceFields at;
  at.hit = HIT;
  at.origin_x = RAY_ORIGIN_X;
  at.direction_x = RAY_DIRECTION_X;
  float u[STEP_DIMENSIONS * LANES];
  for (int j = 0; j < STEP_DIMENSIONS * LANES; j++) u[j] = 0.0f;
  for (int i = 0; i < count; i += LANES) {
    Surfaces surfaces;
    LightReceivers receivers;
    FoundLights found;
    Emissions emissions;
    LightSamples samples;
    float samplings[LIGHT_SAMPLING_FLOATS];
    if (scatters) step_numbers(h, pair, roulette, ints, capacity, i, u);
    find_surfaces(scene, at, f, ints, capacity, i, &surfaces, &receivers, &found);
    prepare_light_lanes(scene, request, at, &surfaces, &receivers, &found, f, ints, capacity, i, u,
                        samplings);
    find_emissions(scene, &found, balances & (step > 0), samplings, &emissions);
    if (scatters)
      sample_lights(scene, &receivers, u + DIM_LIGHT_U * LANES, u + DIM_LIGHT_V * LANES,
                    u + DIM_LIGHT_FINE * LANES, samplings, &samples);
    else
      sample_no_lights(&samples);
    scatter_paths(scene, f, ints, capacity, step, i, u, &surfaces, &emissions, &samples);
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

/// What the last rays found of lights.
STAGE void find_lights(const PRIVATE Scene* scene, const GLOBAL float* RESTRICT f,
                       const GLOBAL int* RESTRICT ints, int capacity, int i,
                       PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 from = LOAD3(f, capacity, RAY_ORIGIN_X, i + j);
      const vec3 toward = LOAD3(f, capacity, RAY_DIRECTION_X, i + j);
      store_found_light(scene, surface_at(scene, ints[HIT * capacity + i + j], from, toward), from, found, j);
    }
}

STAGE void see_emitters(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, int capacity, int i,
                        const PRIVATE Emissions* RESTRICT emissions) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) see_emitter(scene, f, capacity, i + j, load_emission(emissions, j));
}

STAGE void weigh_emitters(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                          int capacity, int i, const PRIVATE Emissions* RESTRICT emissions) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      weigh_emitter(scene, f, ints, capacity, i + j, load_emission(emissions, j));
}

STAGE void sample_emitters(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                           int capacity, int i, const PRIVATE Surfaces* RESTRICT surfaces,
                           const PRIVATE LightSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      sample_emitter(scene, f, ints, capacity, i + j, load_surface(surfaces, j),
                     load_light_sample(samples, j));
}

STAGE void sample_directions(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                             int capacity, int i, const PRIVATE float* RESTRICT u,
                             const PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      sample_direction(scene, f, ints, capacity, i + j, u, j, load_surface(surfaces, j));
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
  const int emitter_samples = h->emitter_samples, bsdf_samples = h->bsdf_samples;
  const int most = emitter_samples > bsdf_samples ? emitter_samples : bsdf_samples;
  if (step < emitter_samples)
    sample_pair(h->sampler, spp, nth_point(pair, emitter_samples, step), ints, capacity, i,
                u + DIM_LIGHT_U * LANES, u + DIM_LIGHT_V * LANES);
  if (step < bsdf_samples)
    sample_pair(h->sampler, spp, nth_point(pair + 1u, bsdf_samples, step), ints, capacity, i,
                u + DIM_BSDF_U * LANES, u + DIM_BSDF_V * LANES);
  if ((step < bsdf_samples) | ((step < emitter_samples) & (h->light_count > 1)))
    sample_pair(h->sampler, spp, nth_point(pair + 2u, most, step), ints, capacity, i,
                u + DIM_LIGHT_FINE * LANES, u + DIM_LOBE_CHOICE * LANES);
}

STAGE void step_direct(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                       int capacity, int count, int step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const bool emits = step < h->emitter_samples, scatters = step < h->bsdf_samples;
  const bool balances = h->bsdf_samples > 0, sees = balances | (step == 0);
  const int rays = balances ? h->bsdf_samples + 1 : 1;
  const bool is_last = step + 1 >= (h->emitter_samples > rays ? h->emitter_samples : rays);
  const LightRequest request = light_request(scene, false, emits, step == 0, balances);
  SurfaceFields at;
  at.hit = CAMERA_HIT;
  at.origin_x = CAMERA_ORIGIN_X;
  at.direction_x = CAMERA_DIRECTION_X;
  float u[STEP_DIMENSIONS * LANES];
  for (int j = 0; j < STEP_DIMENSIONS * LANES; j++) u[j] = 0.0f;
  for (int i = 0; i < count; i += LANES) {
    Surfaces surfaces;
    LightReceivers receivers;
    FoundLights found;
    Emissions emissions;
    LightSamples samples;
    float samplings[LIGHT_SAMPLING_FLOATS];
    direct_numbers(h, step, ints, capacity, i, u);
    // At first the last rays are the camera's.
    if (emits | scatters | balances | (step == 0))
      find_surfaces(scene, at, f, ints, capacity, i, &surfaces, &receivers, &found);
    if (balances & (step > 0)) find_lights(scene, f, ints, capacity, i, &found);
    prepare_light_lanes(scene, request, at, &surfaces, &receivers, &found, f, ints, capacity, i, u,
                        samplings);
    if (sees) find_emissions(scene, &found, step > 0, samplings, &emissions);
    if (balances) weigh_emitters(scene, f, ints, capacity, i, &emissions);
    if (sees & !balances) see_emitters(scene, f, capacity, i, &emissions);
    begin_steps(f, ints, capacity, is_last, i);
    if (emits) {
      sample_lights(scene, &receivers, u + DIM_LIGHT_U * LANES, u + DIM_LIGHT_V * LANES,
                    u + DIM_LIGHT_FINE * LANES, samplings, &samples);
      sample_emitters(scene, f, ints, capacity, i, &surfaces, &samples);
    }
    if (scatters) sample_directions(scene, f, ints, capacity, i, u, &surfaces);
  }
}
#endif

PENUMBRA_NAMESPACE_END
#endif
