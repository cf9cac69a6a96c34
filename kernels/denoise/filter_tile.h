// Non-local means: each pixel becomes the mean of its neighbourhood, weighted by similarity.
#ifndef PENUMBRA_FILTER_TILE_H
#define PENUMBRA_FILTER_TILE_H
#include "kernels/denoise/patch_weights.h"

PENUMBRA_NAMESPACE_BEGIN

/// sums += weights * values
STAGE void add_weighted(const GLOBAL float* RESTRICT weights, const GLOBAL float* RESTRICT values,
                        GLOBAL float* RESTRICT sums) {
  LANE_LOOP
    for (int i = 0; i < DENOISE_TILE_WIDTH; i++) sums[i] += weights[i] * values[i];
}

STAGE void add_row(const GLOBAL float* RESTRICT values, GLOBAL float* RESTRICT sums) {
  LANE_LOOP
    for (int i = 0; i < DENOISE_TILE_WIDTH; i++) sums[i] += values[i];
}

/// values / weights; `otherwise` where there is no weight.
STAGE void divide_by_weights(const GLOBAL float* RESTRICT weights, const GLOBAL float* RESTRICT otherwise,
                             GLOBAL float* RESTRICT values) {
  LANE_LOOP
    for (int i = 0; i < DENOISE_TILE_WIDTH; i++) {
      const float mean = values[i] / max_f(weights[i], LEAST_WEIGHT);
      values[i] = weights[i] > 0.0f ? mean : otherwise[i];
    }
}

FN int filter_scratch_floats(const GLOBAL DenoiseTask* task) {
  const int plane = tile_plane_floats(task);
  return PATCH_SCRATCH + (2 + task->sources) * DENOISE_TILE_PIXELS + (GUIDE_PLANES + task->sources) * plane;
}

/// Filters `sources` planes with the weights of `guide`, which has GUIDE_PLANES planes.
FN void filter_tile(const GLOBAL DenoiseTask* task, int number, const GLOBAL float* guide,
                    const GLOBAL float* sources, GLOBAL float* scratch, GLOBAL float* out) {
  const DenoiseTile tile = denoise_tile(task, number);
  const int r = task->search_radius, plane = tile.pitch * tile.rows;
  GLOBAL float* patches = scratch;
  GLOBAL float* weights = patches + PATCH_SCRATCH;
  GLOBAL float* weight_sums = weights + DENOISE_TILE_PIXELS;
  GLOBAL float* sums = weight_sums + DENOISE_TILE_PIXELS;
  GLOBAL float* tile_guide = sums + task->sources * DENOISE_TILE_PIXELS;
  GLOBAL float* tile_sources = tile_guide + GUIDE_PLANES * plane;
  load_guide(task, &tile, guide, tile_guide);
  load_planes(&tile, sources, task->sources, task->width, 0, task->height, tile_sources);
  for (int i = 0; i < (1 + task->sources) * DENOISE_TILE_PIXELS; i++) weight_sums[i] = 0.0f;
  for (int dy = -r; dy <= r; dy++)
    for (int dx = -r; dx <= r; dx++) {
      patch_weights(task, &tile, tile_guide, dx, dy, CENTRE_IS_PIXEL, patches, weights);
      for (int row = 0; row < DENOISE_TILE_HEIGHT; row++) {
        const int first = row * DENOISE_TILE_WIDTH;
        const int neighbour = (tile.border + row + dy) * tile.pitch + tile.border + dx;
        add_row(weights + first, weight_sums + first);
        for (int k = 0; k < task->sources; k++)
          add_weighted(weights + first, tile_sources + k * plane + neighbour,
                       sums + k * DENOISE_TILE_PIXELS + first);
      }
    }
  for (int k = 0; k < task->sources; k++) {
    GLOBAL float* means = sums + k * DENOISE_TILE_PIXELS;
    for (int row = 0; row < DENOISE_TILE_HEIGHT; row++)
      divide_by_weights(weight_sums + row * DENOISE_TILE_WIDTH,
                        tile_sources + k * plane + (tile.border + row) * tile.pitch + tile.border,
                        means + row * DENOISE_TILE_WIDTH);
    store_tile(task, &tile, means, task->out_row,
               out + (ulong)k * (ulong)task->width * (ulong)task->out_rows);
  }
}

PENUMBRA_NAMESPACE_END
#endif
