// Weights of non-local means: how similar the patches around two pixels are, given their noise.
//
// F. Rousselle, C. Knaus, M. Zwicker, "Adaptive Rendering with Non-Local Means Filtering" (2012), eq. 2 to 5.
// The distance of a pixel p from its neighbour q, in the mean over a patch and its channels, is that of
//   ((u_p - u_q)^2 - (Var_p + min(Var_p, Var_q))) / (epsilon + k^2 (Var_p + Var_q)),
// and p's weight for q is exp(-max(0, distance)). That of q from p differs in one variance only, so that the
// weights for an offset and for its opposite are computed together.
#ifndef PENUMBRA_PATCH_WEIGHTS_H
#define PENUMBRA_PATCH_WEIGHTS_H
#include "kernels/denoise/denoise_task.h"

PENUMBRA_NAMESPACE_BEGIN

#define DISTANCE_EPSILON 1e-8f
// Smaller weights are 0: all neighbours of a pixel together would add less than 1 %.
#define LEAST_WEIGHT 1e-5f

/// Sums over channels of the fractions above, for `rows` x `columns` pixels and their neighbours at `shift`:
/// `of_pixel` with the pixel as p, `of_neighbour` with the neighbour as p; row by row, 0 where one of the two
/// does not exist. The fractions have one division. Images are scaled so that products do not overflow.
STAGE void pair_distances(const GLOBAL float* RESTRICT guide, int plane, int pitch, int shift, int columns,
                          int rows, float k2, GLOBAL float* RESTRICT of_pixel,
                          GLOBAL float* RESTRICT of_neighbour) {
  for (int row = 0; row < rows; row++) {
    const GLOBAL float* RESTRICT p = guide + row * pitch;
    const GLOBAL float* RESTRICT q = p + shift;
    GLOBAL float* RESTRICT to_pixel = of_pixel + row * columns;
    GLOBAL float* RESTRICT to_neighbour = of_neighbour + row * columns;
    LANE_LOOP
      for (int i = 0; i < columns; i++) {
        float square[GUIDE_CHANNELS], noise_p[GUIDE_CHANNELS], noise_q[GUIDE_CHANNELS], unit[GUIDE_CHANNELS];
        UNROLL
        for (int c = 0; c < GUIDE_CHANNELS; c++) {
          noise_p[c] = p[(GUIDE_CHANNELS + c) * plane + i];
          noise_q[c] = q[(GUIDE_CHANNELS + c) * plane + i];
          square[c] = sqr(p[c * plane + i] - q[c * plane + i]) - min_f(noise_p[c], noise_q[c]);
          unit[c] = DISTANCE_EPSILON + k2 * (noise_p[c] + noise_q[c]);
        }
        const float both = p[VALID_PLANE * plane + i] * q[VALID_PLANE * plane + i];
        const float product = unit[0] * unit[1], inverse = both / (product * unit[2]);
        const float of_two = inverse * unit[2];
        const float per_unit[GUIDE_CHANNELS] = {of_two * unit[1], of_two * unit[0], inverse * product};
        float as_pixel = 0.0f, as_neighbour = 0.0f;
        UNROLL
        for (int c = 0; c < GUIDE_CHANNELS; c++) {
          as_pixel += (square[c] - noise_p[c]) * per_unit[c];
          as_neighbour += (square[c] - noise_q[c]) * per_unit[c];
        }
        to_pixel[i] = as_pixel;
        to_neighbour[i] = as_neighbour;
      }
  }
}

/// 2^-t for t >= 0, 0 where that is less than LEAST_WEIGHT; relative error below 2e-7 + 6e-8 t.
FN float weight_of(float t) {
  const float bounded = min_f(t, 30.0f);
  const int n = TO_INT(bounded + 0.5f);
  const float r = TO_FLOAT(n) - bounded, r2 = r * r;  // in [-0.5, 0.5]
  // The series of 2^r, its even and odd terms side by side: one long chain of operations would be slower.
  const float even = 1.0f + r2 * (0.240226507f + r2 * (0.00961812911f + r2 * 1.54035304e-4f));
  const float odd = 0.693147181f + r2 * (0.0555041087f + r2 * 0.00133335581f);
  const float weight = BITS_FLOAT(FLOAT_BITS(even + r * odd) - (TO_UINT(n) << 23));
  return weight < LEAST_WEIGHT ? 0.0f : weight;
}

/// The sum of an odd number of values, `step` apart.
FN float sum_of(const GLOBAL float* RESTRICT values, int step, int terms) {
  float sum = values[0];
  UNROLL
  for (int k = 1; k < terms; k += 2) sum += values[k * step] + values[(k + 1) * step];
  return sum;
}

/// The next multiple of the width of a register.
FN int whole_vectors(int count) { return (count + VECTOR_WIDTH - 1) / VECTOR_WIDTH * VECTOR_WIDTH; }

/// The weights of a tile's pixels from the distances of its rows with a border of f pixels, `columns` apart.
/// `terms` is 2 f + 1. `valid` tells whether neighbours exist.
FN void weights_of_patches(const GLOBAL float* RESTRICT distances, int columns, int terms,
                           const GLOBAL float* RESTRICT valid, int pitch, GLOBAL float* RESTRICT column_sums,
                           GLOBAL float* RESTRICT weights) {
  const float scale = 1.44269504f / (float)(GUIDE_CHANNELS * terms * terms);  // 2^-t for e^-t
  const int sums = whole_vectors(DENOISE_TILE_WIDTH + terms - 1);
  for (int row = 0; row < DENOISE_TILE_HEIGHT; row++) {
    const GLOBAL float* RESTRICT from = distances + row * columns;
    GLOBAL float* RESTRICT to = column_sums + row * sums;
    LANE_LOOP
      for (int i = 0; i < sums; i++) to[i] = sum_of(from + i, columns, terms);
  }
  for (int row = 0; row < DENOISE_TILE_HEIGHT; row++) {
    const GLOBAL float* RESTRICT from = column_sums + row * sums;
    const GLOBAL float* RESTRICT exists = valid + row * pitch;
    GLOBAL float* RESTRICT to = weights + row * DENOISE_TILE_WIDTH;
    LANE_LOOP
      for (int i = 0; i < DENOISE_TILE_WIDTH; i++)
        to[i] = weight_of(max_f(sum_of(from + i, 1, terms) * scale, 0.0f)) * exists[i];
  }
}

STAGE void patch_weights(const GLOBAL float* RESTRICT distances, int columns, int patch_radius,
                         const GLOBAL float* RESTRICT valid, int pitch, GLOBAL float* RESTRICT column_sums,
                         GLOBAL float* RESTRICT weights) {
  if (patch_radius == 0) weights_of_patches(distances, columns, 1, valid, pitch, column_sums, weights);
  if (patch_radius == 1) weights_of_patches(distances, columns, 3, valid, pitch, column_sums, weights);
  if (patch_radius == 2) weights_of_patches(distances, columns, 5, valid, pitch, column_sums, weights);
  if (patch_radius == 3) weights_of_patches(distances, columns, 7, valid, pitch, column_sums, weights);
  if (patch_radius == 4) weights_of_patches(distances, columns, 9, valid, pitch, column_sums, weights);
  if (patch_radius == 5) weights_of_patches(distances, columns, 11, valid, pitch, column_sums, weights);
}

/// Which of the two pixels of an offset the weight belongs to: the one whose noise is removed.
enum { CENTRE_IS_PIXEL, CENTRE_IS_NEIGHBOUR };

// Distances of a tile with the border that its patches and its opposite neighbours need.
#define DISTANCE_COLUMNS (DENOISE_TILE_WIDTH + 2 * MAX_PATCH_RADIUS + MAX_SEARCH_RADIUS + 16)
#define DISTANCE_ROWS (DENOISE_TILE_HEIGHT + 2 * MAX_PATCH_RADIUS + MAX_SEARCH_RADIUS)
/// Floats of scratch memory that pair_weights needs.
#define PAIR_SCRATCH (3 * DISTANCE_ROWS * DISTANCE_COLUMNS)

/// The number of pairs of an offset and its opposite. With the pixel itself they are all (2r + 1)^2
/// neighbours.
FN int offset_pairs(const GLOBAL DenoiseTask* task) {
  return ((2 * task->search_radius + 1) * (2 * task->search_radius + 1) - 1) / 2;
}

/// An offset (dx, dy), and the same in a tile with border.
typedef struct {
  int dx, dy, shift;
} PairOffset;

FN PairOffset pair_offset(const GLOBAL DenoiseTask* task, const PRIVATE DenoiseTile* tile, int pair) {
  const int side = 2 * task->search_radius + 1, n = pair + 1 + task->search_radius * (side + 1);
  PairOffset offset;
  offset.dx = n % side - task->search_radius;
  offset.dy = n / side - task->search_radius;
  offset.shift = offset.dy * tile->pitch + offset.dx;
  return offset;
}

/// The weights of all pixels of a tile for their neighbours at the offset (`weights`) and at its opposite
/// (`opposite`), row by row without border. `guide`: GUIDE_PLANES planes of the tile with border.
FN void pair_weights(const GLOBAL DenoiseTask* task, const PRIVATE DenoiseTile* tile,
                     const GLOBAL float* guide, const PRIVATE PairOffset* offset, int centre,
                     GLOBAL float* scratch, GLOBAL float* weights, GLOBAL float* opposite) {
  const int f = task->patch_radius, plane = tile->pitch * tile->rows, dx = offset->dx, dy = offset->dy;
  // The weights for opposite neighbours are those of pairs that begin at the tile moved by the opposite
  // offset.
  const int left = f + max_i(dx, 0), above = f + dy;
  const int columns = whole_vectors(left + DENOISE_TILE_WIDTH + max_i(-dx, 0) + f);
  const int rows = above + DENOISE_TILE_HEIGHT + f;
  GLOBAL float* of_pixel = scratch;
  GLOBAL float* of_neighbour = of_pixel + DISTANCE_ROWS * DISTANCE_COLUMNS;
  GLOBAL float* column_sums = of_neighbour + DISTANCE_ROWS * DISTANCE_COLUMNS;
  pair_distances(guide + (tile->border - above) * tile->pitch + tile->border - left, plane, tile->pitch,
                 offset->shift, columns, rows, sqr(task->strength), of_pixel, of_neighbour);
  const int here = (above - f) * columns + left - f, moved = here - dy * columns - dx;
  const GLOBAL float* valid = guide + VALID_PLANE * plane + tile->border * tile->pitch + tile->border;
  const bool is_pixel = centre == CENTRE_IS_PIXEL;
  patch_weights((is_pixel ? of_pixel : of_neighbour) + here, columns, f, valid + offset->shift, tile->pitch,
                column_sums, weights);
  patch_weights((is_pixel ? of_neighbour : of_pixel) + moved, columns, f, valid - offset->shift, tile->pitch,
                column_sums, opposite);
}

PENUMBRA_NAMESPACE_END
#endif
