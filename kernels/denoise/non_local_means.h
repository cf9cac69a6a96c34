// Non-local means: each pixel becomes the mean of its neighbourhood, weighted by similarity.
#ifndef PENUMBRA_NON_LOCAL_MEANS_H
#define PENUMBRA_NON_LOCAL_MEANS_H
#include "kernels/denoise/patch_weights.h"

PENUMBRA_NAMESPACE_BEGIN

/// sums += weights * values, for neighbours at `shift` and at the opposite. `values` point to the tile's
/// first pixel.
STAGE void add_pair(const GLOBAL float* RESTRICT weights, const GLOBAL float* RESTRICT opposite,
                    const GLOBAL float* RESTRICT values, int pitch, int shift, GLOBAL float* RESTRICT sums) {
  for (int row = 0; row < DENOISE_TILE_HEIGHT; row++) {
    const int first = row * DENOISE_TILE_WIDTH;
    const GLOBAL float* RESTRICT at = values + row * pitch;
    LANE_LOOP
      for (int i = 0; i < DENOISE_TILE_WIDTH; i++)
        sums[first + i] += weights[first + i] * at[i + shift] + opposite[first + i] * at[i - shift];
  }
}

STAGE void add_weights(const GLOBAL float* RESTRICT weights, const GLOBAL float* RESTRICT opposite,
                       GLOBAL float* RESTRICT sums) {
  LANE_LOOP
    for (int i = 0; i < DENOISE_TILE_PIXELS; i++) sums[i] += weights[i] + opposite[i];
}

/// The tile's own pixels, with their weight of 1 where they exist.
STAGE void begin_sums(const GLOBAL float* RESTRICT valid, const GLOBAL float* RESTRICT values, int pitch,
                      GLOBAL float* RESTRICT sums) {
  for (int row = 0; row < DENOISE_TILE_HEIGHT; row++) {
    LANE_LOOP
      for (int i = 0; i < DENOISE_TILE_WIDTH; i++)
        sums[row * DENOISE_TILE_WIDTH + i] = valid[row * pitch + i] * values[row * pitch + i];
  }
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
  return PAIR_SCRATCH + (3 + task->sources) * DENOISE_TILE_PIXELS + (GUIDE_PLANES + task->sources) * plane;
}

/// Filters `sources` planes with the weights of `guide`, which has GUIDE_PLANES planes.
FN void filter_tile(const GLOBAL DenoiseTask* task, int number, const GLOBAL float* guide,
                    const GLOBAL float* sources, GLOBAL float* scratch, GLOBAL float* out) {
  const DenoiseTile tile = denoise_tile(task, number);
  const int plane = tile.pitch * tile.rows, first_pixel = tile.border * tile.pitch + tile.border;
  GLOBAL float* weights = scratch + PAIR_SCRATCH;
  GLOBAL float* opposite = weights + DENOISE_TILE_PIXELS;
  GLOBAL float* weight_sums = opposite + DENOISE_TILE_PIXELS;
  GLOBAL float* sums = weight_sums + DENOISE_TILE_PIXELS;
  GLOBAL float* tile_guide = sums + task->sources * DENOISE_TILE_PIXELS;
  GLOBAL float* tile_sources = tile_guide + GUIDE_PLANES * plane;
  load_guide(task, &tile, guide, tile_guide);
  load_planes(&tile, sources, task->sources, task->width, 0, task->height, tile_sources);
  const GLOBAL float* valid = tile_guide + VALID_PLANE * plane + first_pixel;
  begin_sums(valid, valid, tile.pitch, weight_sums);
  for (int k = 0; k < task->sources; k++)
    begin_sums(valid, tile_sources + k * plane + first_pixel, tile.pitch, sums + k * DENOISE_TILE_PIXELS);
  for (int pair = 0; pair < offset_pairs(task); pair++) {
    const PairOffset offset = pair_offset(task, &tile, pair);
    pair_weights(task, &tile, tile_guide, &offset, CENTRE_IS_PIXEL, scratch, weights, opposite);
    add_weights(weights, opposite, weight_sums);
    for (int k = 0; k < task->sources; k++)
      add_pair(weights, opposite, tile_sources + k * plane + first_pixel, tile.pitch, offset.shift,
               sums + k * DENOISE_TILE_PIXELS);
  }
  for (int k = 0; k < task->sources; k++) {
    GLOBAL float* means = sums + k * DENOISE_TILE_PIXELS;
    for (int row = 0; row < DENOISE_TILE_HEIGHT; row++)
      divide_by_weights(weight_sums + row * DENOISE_TILE_WIDTH,
                        tile_sources + k * plane + first_pixel + row * tile.pitch,
                        means + row * DENOISE_TILE_WIDTH);
    store_tile(task, &tile, means, task->out_row,
               out + (ulong)k * (ulong)task->width * (ulong)task->out_rows);
  }
}

PENUMBRA_NAMESPACE_END
#endif
