// The stages of a block that step its paths by an integrator.
#ifndef PENUMBRA_BLOCK_STEP_H
#define PENUMBRA_BLOCK_STEP_H
#include "kernels/block_aim.h"
#include "kernels/integrator_direct.h"
#include "kernels/integrator_path.h"

PENUMBRA_NAMESPACE_BEGIN

/// The first three pairs of a step's numbers, for LANES paths from lane i on.
FN void draw_step(const PRIVATE SceneHeader* h, uint pair, const GLOBAL int* RESTRICT ints, int capacity,
                  int i, PRIVATE float* RESTRICT u) {
  const uint spp = sequence_length(h);
  draw_pair(h->sampler, spp, pair, ints, capacity, i, u + DRAW_LIGHT_U * LANES, u + DRAW_LIGHT_V * LANES);
  draw_pair(h->sampler, spp, pair + 1u, ints, capacity, i, u + DRAW_BSDF_U * LANES, u + DRAW_BSDF_V * LANES);
  draw_pair(h->sampler, spp, pair + 2u, ints, capacity, i, u + DRAW_LIGHT_CHOICE * LANES,
            u + DRAW_LOBE_CHOICE * LANES);
}

#if HAS(PATH)
STAGE void step_paths(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                      int capacity, int count, int step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const uint pair = step_pair(step);
  const bool roulette = step + 1 >= h->rr_depth, scatters = step + 1 < h->max_depth;
  const AimWishes wishes = aim_wishes(scene, true, scatters, scatters, h->direct_sampling == SAMPLING_MIS);
  SurfaceFields lit;
  lit.hit = HIT;
  lit.origin_x = RAY_ORIGIN_X;
  lit.direction_x = RAY_DIRECTION_X;
  for (int i = 0; i < count; i += LANES) {
    float u[DRAWS * LANES];
    draw_step(h, pair, ints, capacity, i, u);
    for (int j = 0; j < LANES; j++) u[DRAW_ROULETTE * LANES + j] = 0.0f;
    if (roulette) {
      draw_pair(h->sampler, sequence_length(h), pair + 3u, ints, capacity, i, u + DRAW_ROULETTE * LANES,
                u + DRAW_SPARE * LANES);
    }
    float aims[AIM_FLOATS];
    aim_lanes(scene, wishes, lit, f, ints, capacity, i, u, aims);
    LANE_LOOP
      for (int j = 0; j < LANES; j++) path_step(scene, f, ints, capacity, step, i + j, u, j, aims);
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

  #if HAS(POLYGONS)
STAGE void see_emitters_lanes(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                              int capacity, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) see_emitters(scene, f, ints, capacity, j);
}
  #endif

STAGE void step_direct(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                       int capacity, int count, int step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const uint pair = step_pair(step);
  const AimWishes wishes = aim_wishes(scene, false, step<h->emitter_samples, step == 0, h->bsdf_samples> 0);
  SurfaceFields lit;
  lit.hit = CAMERA_HIT;
  lit.origin_x = CAMERA_ORIGIN_X;
  lit.direction_x = CAMERA_DIRECTION_X;
  for (int i = 0; i < count; i += LANES) {
    float u[DRAWS * LANES];
    draw_step(h, pair, ints, capacity, i, u);
    float aims[AIM_FLOATS];
    aim_lanes(scene, wishes, lit, f, ints, capacity, i, u, aims);
  #if HAS(POLYGONS)
    if (h->emitter_samples + h->bsdf_samples == 0) {
      see_emitters_lanes(scene, f, ints, capacity, i);
      continue;
    }
  #endif
    LANE_LOOP
      for (int j = 0; j < LANES; j++) direct_step(scene, f, ints, capacity, step, i + j, u, j, aims);
  }
}
#endif

PENUMBRA_NAMESPACE_END
#endif
