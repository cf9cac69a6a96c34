// Non-local means: each pixel becomes the mean of its neighbourhood, weighted by similarity: by how similar
// the patches around two pixels are, given their noise.
//
// F. Rousselle, C. Knaus, M. Zwicker, "Adaptive Rendering with Non-Local Means Filtering" (2012), eq. 2 to 5.
#ifndef PENUMBRA_NON_LOCAL_MEANS_H
#define PENUMBRA_NON_LOCAL_MEANS_H
#include "kernels/denoise/denoise_task.h"

PENUMBRA_NAMESPACE_BEGIN

#define DISTANCE_EPSILON 1e-8f
// Smaller weights are 0: all neighbours of a pixel together would add less than 1 %.
#define LEAST_WEIGHT 1e-5f

/// Which of the two pixels of an offset the weight belongs to: the one whose noise is removed.
enum { CENTRE_IS_PIXEL, CENTRE_IS_NEIGHBOUR };

/// Squared differences of pixels and their neighbours at `shift`, relative to their noise, in the sum over
/// channels:
///   ((u_p - u_q)^2 - (Var_c + min(Var_p, Var_q))) / (epsilon + k^2 (Var_p + Var_q)),   c: the centre
/// All three fractions have one division. Images are scaled so that the products do not overflow.
STAGE void pixel_distances(const GLOBAL float* RESTRICT guide, int plane, int pixel, int shift, int count,
                           float k2, float of_neighbour, GLOBAL float* RESTRICT distances) {
  const GLOBAL float* RESTRICT p = guide + pixel;
  const GLOBAL float* RESTRICT q = guide + pixel + shift;
  LANE_LOOP
    for (int i = 0; i < count; i++) {
      float numerator[GUIDE_CHANNELS], denominator[GUIDE_CHANNELS];
      UNROLL
      for (int c = 0; c < GUIDE_CHANNELS; c++) {
        const float difference = p[c * plane + i] - q[c * plane + i];
        const float of_p = p[(GUIDE_CHANNELS + c) * plane + i], of_q = q[(GUIDE_CHANNELS + c) * plane + i];
        const float of_centre = of_p + of_neighbour * (of_q - of_p);
        numerator[c] = difference * difference - (of_centre + min_f(of_p, of_q));
        denominator[c] = DISTANCE_EPSILON + k2 * (of_p + of_q);
      }
      const float product = denominator[0] * denominator[1];
      const float sum = (numerator[0] * denominator[1] + numerator[1] * denominator[0]) * denominator[2] +
                        numerator[2] * product;
      const float both = p[VALID_PLANE * plane + i] * q[VALID_PLANE * plane + i];
      const float distance = sum / (product * denominator[2]);
      distances[i] = both > 0.0f ? distance : 0.0f;
    }
}

FN void sum_terms(const GLOBAL float* RESTRICT values, int step, int terms, int count,
                  GLOBAL float* RESTRICT sums) {
  LANE_LOOP
    for (int i = 0; i < count; i++) {
      float sum = values[i];
      UNROLL
      for (int k = 1; k < terms; k++) sum += values[i + k * step];
      sums[i] = sum;
    }
}

/// sums[i] = values[i] + values[i + step] + ..., 2 patch_radius + 1 terms.
STAGE void sum_of_shifted(const GLOBAL float* RESTRICT values, int step, int patch_radius, int count,
                          GLOBAL float* RESTRICT sums) {
  if (patch_radius == 0) sum_terms(values, step, 1, count, sums);
  if (patch_radius == 1) sum_terms(values, step, 3, count, sums);
  if (patch_radius == 2) sum_terms(values, step, 5, count, sums);
  if (patch_radius == 3) sum_terms(values, step, 7, count, sums);
  if (patch_radius == 4) sum_terms(values, step, 9, count, sums);
  if (patch_radius == 5) sum_terms(values, step, 11, count, sums);
}

/// exp(-max(0, d^2)), 0 for neighbours that do not exist.
STAGE void weights_of_distances(const GLOBAL float* RESTRICT sums, float scale,
                                const GLOBAL float* RESTRICT valid, GLOBAL float* RESTRICT weights) {
  LANE_LOOP
    for (int i = 0; i < DENOISE_TILE_WIDTH; i++) {
      const float weight = exp_f(-max_f(sums[i] * scale, 0.0f)) * valid[i];
      weights[i] = weight < LEAST_WEIGHT ? 0.0f : weight;
    }
}

/// Floats of scratch memory that patch_weights needs.
#define PATCH_PITCH (DENOISE_TILE_WIDTH + 16)
#define PATCH_ROWS (DENOISE_TILE_HEIGHT + 2 * MAX_PATCH_RADIUS)
#define PATCH_SCRATCH (2 * PATCH_PITCH * PATCH_ROWS)

/// The weights of all pixels of a tile for their neighbours at the offset (dx, dy), row by row without
/// border. `guide`: GUIDE_PLANES planes of the tile with border. A pixel's weight for itself is 1.
STAGE void patch_weights(const GLOBAL DenoiseTask* task, const PRIVATE DenoiseTile* tile,
                         const GLOBAL float* RESTRICT guide, int dx, int dy, int centre,
                         GLOBAL float* RESTRICT scratch, GLOBAL float* RESTRICT weights) {
  const int f = task->patch_radius, side = 2 * f + 1, plane = tile->pitch * tile->rows;
  const int shift = dy * tile->pitch + dx;
  const int rows = DENOISE_TILE_HEIGHT + 2 * f;
  GLOBAL float* distances = scratch;
  GLOBAL float* sums = scratch + PATCH_PITCH * PATCH_ROWS;
  for (int row = 0; row < rows; row++) {
    const int pixel = (tile->border - f + row) * tile->pitch + tile->border - f;
    pixel_distances(guide, plane, pixel, shift, PATCH_PITCH, sqr(task->strength),
                    centre == CENTRE_IS_NEIGHBOUR ? 1.0f : 0.0f, distances);
    sum_of_shifted(distances, 1, f, DENOISE_TILE_WIDTH, sums + row * DENOISE_TILE_WIDTH);
  }
  const float scale = 1.0f / (float)(GUIDE_CHANNELS * side * side);
  for (int row = 0; row < DENOISE_TILE_HEIGHT; row++) {
    sum_of_shifted(sums + row * DENOISE_TILE_WIDTH, DENOISE_TILE_WIDTH, f, DENOISE_TILE_WIDTH, distances);
    const int neighbour = (tile->border + row) * tile->pitch + tile->border + shift;
    weights_of_distances(distances, scale, guide + VALID_PLANE * plane + neighbour,
                         weights + row * DENOISE_TILE_WIDTH);
  }
}

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
