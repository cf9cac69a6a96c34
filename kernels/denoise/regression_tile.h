// First-order regression: around each pixel, colour is fitted as a linear function of features (albedo,
// normal, depth), with the weights of non-local means. Each pixel then becomes the mean of what the models of
// its neighbourhood predict for it. Models are fitted to every second neighbour, those at even distances |dx|
// + |dy|; the models that a pixel gets its colour from are around all of its neighbours, odd and even.
//
// B. Bitterli et al., "Nonlinearly Weighted First-order Regression for Denoising Monte Carlo Renderings"
// (2016), sections 3 and 5.2.
#ifndef PENUMBRA_REGRESSION_TILE_H
#define PENUMBRA_REGRESSION_TILE_H
#include "kernels/denoise/non_local_means.h"

PENUMBRA_NAMESPACE_BEGIN

// The normal matrix X^T W X, row by row above its diagonal, then the right sides X^T W Y.
#define NORMAL_ENTRIES (REGRESSION_TERMS * (REGRESSION_TERMS + 1) / 2)
#define NORMAL_ROWS (NORMAL_ENTRIES + REGRESSION_COLORS * REGRESSION_TERMS)
FN int normal_entry(int row, int column) {
  return row * REGRESSION_TERMS - row * (row - 1) / 2 + column - row;
}
FN int right_entry(int color, int term) { return NORMAL_ENTRIES + color * REGRESSION_TERMS + term; }

// A slope is damped where a feature varies in a neighbourhood by less than this, in units of the feature's
// range in the image; and all slopes by this share.
#define FEATURE_FLOOR 1e-3f
#define RELATIVE_RIDGE 1e-3f

// The weights for half the bandwidth are those for the whole one to the power of 4.
FN float weight_at_bandwidth(float weight, int bandwidth) {
  const float square = weight * weight, narrow = square * square;
  return bandwidth == 0 ? (narrow < LEAST_WEIGHT ? 0.0f : narrow) : weight;
}

/// Whether any of LANES weights is not 0 at the bandwidth.
STAGE bool any_weight(const GLOBAL float* RESTRICT weights, int bandwidth) {
  uint bits = 0u;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) bits |= FLOAT_BITS(weight_at_bandwidth(weights[j], bandwidth));
  return bits != 0u;
}

// Neighbours that are added together: sums of the normal equations are read and written once for all.
#define BATCH 4
typedef struct {
  int n[BATCH], shift[BATCH];  ///< numbers of neighbours, and where they are
  int count;
} NeighbourBatch;

/// Adds BATCH neighbours of LANES pixels to their normal equations, one after the other. `features` and
/// `colors` point to the pixels.
STAGE void add_neighbours(const PRIVATE NeighbourBatch* batch, const GLOBAL float* RESTRICT weights,
                          int bandwidth, const GLOBAL float* RESTRICT features,
                          const GLOBAL float* RESTRICT colors, int plane, GLOBAL float* RESTRICT normal) {
  const int n0 = batch->n[0], n1 = batch->n[1], n2 = batch->n[2], n3 = batch->n[3];
  const int s0 = batch->shift[0], s1 = batch->shift[1], s2 = batch->shift[2], s3 = batch->shift[3];
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float w[BATCH] = {weight_at_bandwidth(weights[n0 * LANES + j], bandwidth),
                              weight_at_bandwidth(weights[n1 * LANES + j], bandwidth),
                              weight_at_bandwidth(weights[n2 * LANES + j], bandwidth),
                              weight_at_bandwidth(weights[n3 * LANES + j], bandwidth)};
      float x[BATCH][REGRESSION_TERMS];
      float y[BATCH][REGRESSION_COLORS];
      UNROLL
      for (int k = 0; k < REGRESSION_FEATURES; k++) {
        const GLOBAL float* feature = features + k * plane + j;
        x[0][1 + k] = feature[s0] - feature[0];
        x[1][1 + k] = feature[s1] - feature[0];
        x[2][1 + k] = feature[s2] - feature[0];
        x[3][1 + k] = feature[s3] - feature[0];
      }
      UNROLL
      for (int c = 0; c < REGRESSION_COLORS; c++) {
        const GLOBAL float* color = colors + c * plane + j;
        y[0][c] = color[s0];
        y[1][c] = color[s1];
        y[2][c] = color[s2];
        y[3][c] = color[s3];
      }
      UNROLL
      for (int a = 0; a < REGRESSION_TERMS; a++) {
        float wx[BATCH];
        UNROLL
        for (int i = 0; i < BATCH; i++) wx[i] = a == 0 ? w[i] : w[i] * x[i][a];
        UNROLL
        for (int b = a; b < REGRESSION_TERMS; b++) {
          float sum = normal[normal_entry(a, b) * LANES + j];
          UNROLL
          for (int i = 0; i < BATCH; i++) sum += b == 0 ? wx[i] : wx[i] * x[i][b];
          normal[normal_entry(a, b) * LANES + j] = sum;
        }
        UNROLL
        for (int c = 0; c < REGRESSION_COLORS; c++) {
          float sum = normal[right_entry(c, a) * LANES + j];
          UNROLL
          for (int i = 0; i < BATCH; i++) sum += wx[i] * y[i][c];
          normal[right_entry(c, a) * LANES + j] = sum;
        }
      }
    }
}

/// Solves the normal equations of LANES pixels by Cholesky's method, in place: the right sides become the
/// models.
STAGE void solve_normal(GLOBAL float* RESTRICT normal) {
  for (int k = 1; k < REGRESSION_TERMS; k++) {
    GLOBAL float* RESTRICT diagonal = normal + normal_entry(k, k) * LANES;
    LANE_LOOP
      for (int j = 0; j < LANES; j++)
        diagonal[j] = diagonal[j] * (1.0f + RELATIVE_RIDGE) + normal[j] * (FEATURE_FLOOR * FEATURE_FLOOR);
  }
  // U^T U, with the inverse of U's diagonal in the diagonal.
  for (int row = 0; row < REGRESSION_TERMS; row++) {
    GLOBAL float* RESTRICT diagonal = normal + normal_entry(row, row) * LANES;
    LANE_LOOP
      for (int j = 0; j < LANES; j++) diagonal[j] = 1.0f / SQRT(max_f(diagonal[j], 1e-20f));
    for (int column = row + 1; column < REGRESSION_TERMS; column++) {
      GLOBAL float* RESTRICT entry = normal + normal_entry(row, column) * LANES;
      LANE_LOOP
        for (int j = 0; j < LANES; j++) entry[j] *= diagonal[j];
    }
    for (int a = row + 1; a < REGRESSION_TERMS; a++)
      for (int b = a; b < REGRESSION_TERMS; b++) {
        const GLOBAL float* RESTRICT u = normal + normal_entry(row, a) * LANES;
        const GLOBAL float* RESTRICT v = normal + normal_entry(row, b) * LANES;
        GLOBAL float* RESTRICT entry = normal + normal_entry(a, b) * LANES;
        LANE_LOOP
          for (int j = 0; j < LANES; j++) entry[j] -= u[j] * v[j];
      }
  }
  for (int c = 0; c < REGRESSION_COLORS; c++) {
    for (int row = 0; row < REGRESSION_TERMS; row++) {
      GLOBAL float* RESTRICT right = normal + right_entry(c, row) * LANES;
      for (int k = 0; k < row; k++) {
        const GLOBAL float* RESTRICT u = normal + normal_entry(k, row) * LANES;
        const GLOBAL float* RESTRICT known = normal + right_entry(c, k) * LANES;
        LANE_LOOP
          for (int j = 0; j < LANES; j++) right[j] -= u[j] * known[j];
      }
      const GLOBAL float* RESTRICT inverse = normal + normal_entry(row, row) * LANES;
      LANE_LOOP
        for (int j = 0; j < LANES; j++) right[j] *= inverse[j];
    }
    for (int row = REGRESSION_TERMS - 1; row >= 0; row--) {
      GLOBAL float* RESTRICT right = normal + right_entry(c, row) * LANES;
      for (int k = row + 1; k < REGRESSION_TERMS; k++) {
        const GLOBAL float* RESTRICT u = normal + normal_entry(row, k) * LANES;
        const GLOBAL float* RESTRICT known = normal + right_entry(c, k) * LANES;
        LANE_LOOP
          for (int j = 0; j < LANES; j++) right[j] -= u[j] * known[j];
      }
      const GLOBAL float* RESTRICT inverse = normal + normal_entry(row, row) * LANES;
      LANE_LOOP
        for (int j = 0; j < LANES; j++) right[j] *= inverse[j];
    }
  }
}

/// What the models of LANES neighbours at `shift` predict for pixels, added to `sums` (colours,
/// DENOISE_TILE_PIXELS apart), at both bandwidths.
STAGE void add_prediction(const GLOBAL float* RESTRICT weights, const GLOBAL float* RESTRICT features,
                          const GLOBAL float* RESTRICT models, int plane, int shift,
                          GLOBAL float* RESTRICT weight_sums, GLOBAL float* RESTRICT sums) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      float x[REGRESSION_TERMS];
      UNROLL
      for (int k = 0; k < REGRESSION_FEATURES; k++)
        x[1 + k] = features[k * plane + j] - features[k * plane + shift + j];
      UNROLL
      for (int b = 0; b < REGRESSION_BANDWIDTHS; b++) {
        const float w = weight_at_bandwidth(weights[j], b);
        weight_sums[b * DENOISE_TILE_PIXELS + j] += w;
        UNROLL
        for (int c = 0; c < REGRESSION_COLORS; c++) {
          const GLOBAL float* RESTRICT model =
              models + (b * REGRESSION_COLORS + c) * REGRESSION_TERMS * plane + shift;
          // Two chains of sums, as one would be slower.
          float color = model[j], rest = model[plane + j] * x[1];
          UNROLL
          for (int k = 2; k + 1 < REGRESSION_TERMS; k += 2) {
            color += model[k * plane + j] * x[k];
            rest += model[(k + 1) * plane + j] * x[k + 1];
          }
          sums[(b * REGRESSION_COLORS + c) * DENOISE_TILE_PIXELS + j] += w * (color + rest);
        }
      }
    }
}

/// Stores the weights of a tile for neighbour `n`, so that the weights of LANES pixels for all neighbours
/// follow each other.
STAGE void keep_weights(const GLOBAL float* RESTRICT weights, int pitch, int n, int neighbours,
                        GLOBAL float* RESTRICT kept) {
  for (int row = 0; row < DENOISE_TILE_HEIGHT; row++)
    for (int group = 0; group < DENOISE_TILE_WIDTH / LANES; group++) {
      const GLOBAL float* RESTRICT from = weights + row * pitch + group * LANES;
      GLOBAL float* RESTRICT to =
          kept + ((row * (DENOISE_TILE_WIDTH / LANES) + group) * neighbours + n) * LANES;
      LANE_LOOP
        for (int j = 0; j < LANES; j++) to[j] = from[j];
    }
}

// Models are fitted to every second neighbour.
#define FIT_STEP 2

/// The number of every `step`-th of (2r + 1)^2 neighbours, row by row, with the pixel itself.
FN int neighbours_of(int search_radius, int step) {
  return ((2 * search_radius + 1) * (2 * search_radius + 1) - 1) / step + 1;
}

/// Where neighbour n of those is in a tile.
FN int neighbour_shift(const PRIVATE DenoiseTile* tile, int search_radius, int step, int n) {
  const int side = 2 * search_radius + 1;
  return (step * n / side - search_radius) * tile->pitch + step * n % side - search_radius;
}

/// Keeps the weights of a tile for every `step`-th neighbour, `kept` for each pixel. `pair` is memory for
/// those of two neighbours.
FN void keep_all_weights(const GLOBAL DenoiseTask* task, const PRIVATE DenoiseTile* tile,
                         const GLOBAL float* guide, int centre_is, int step, int kept, GLOBAL float* scratch,
                         GLOBAL float* pair, GLOBAL float* weights) {
  const int centre = neighbours_of(task->search_radius, step) / 2;
  const int own = VALID_PLANE * tile->pitch * tile->rows + tile->border * tile->pitch + tile->border;
  keep_weights(guide + own, tile->pitch, centre, kept, weights);
  GLOBAL float* opposite = pair + DENOISE_TILE_PIXELS;
  for (int k = 1; k <= centre; k++) {
    const PairOffset offset = pair_offset(task, tile, step * k - 1);
    pair_weights(task, tile, guide, &offset, centre_is, scratch, pair, opposite);
    keep_weights(pair, DENOISE_TILE_WIDTH, centre + k, kept, weights);
    keep_weights(opposite, DENOISE_TILE_WIDTH, centre - k, kept, weights);
  }
}

FN int fit_scratch_floats(const GLOBAL DenoiseTask* task) {
  const int plane = tile_plane_floats(task);
  return PAIR_SCRATCH + NORMAL_ROWS * 16 +
         DENOISE_TILE_PIXELS * (2 + neighbours_of(task->search_radius, FIT_STEP) + 1) +
         (GUIDE_PLANES + REGRESSION_FEATURES + REGRESSION_COLORS) * plane;
}

FN int tile_model_floats() { return MODEL_PLANES * DENOISE_TILE_PIXELS; }

/// Loads the models of a tile with its border. Outside of the image they are arbitrary, but finite.
STAGE void load_models(const GLOBAL DenoiseTask* task, const PRIVATE DenoiseTile* tile,
                       const GLOBAL float* RESTRICT models, GLOBAL float* RESTRICT to) {
  const int across = denoise_tiles_across(task);
  const int first = tile->x - tile->border;
  for (int row = 0; row < tile->rows; row++) {
    const int y = max_i(0, min_i(tile->y - tile->border + row - task->model_row, task->model_rows - 1));
    for (int column = 0; column < tile->pitch;) {
      // Up to the end of a tile of models, or of the columns that are before or behind all of them.
      const int x = max_i(0, min_i(first + column, across * DENOISE_TILE_WIDTH - 1));
      const int in_tile = x % DENOISE_TILE_WIDTH;
      const bool is_inside = x == first + column;
      const int count = is_inside ? min_i(DENOISE_TILE_WIDTH - in_tile, tile->pitch - column) : 1;
      const GLOBAL float* from =
          models +
          (ulong)(y / DENOISE_TILE_HEIGHT * across + x / DENOISE_TILE_WIDTH) * (ulong)tile_model_floats() +
          y % DENOISE_TILE_HEIGHT * DENOISE_TILE_WIDTH + in_tile;
      for (int k = 0; k < MODEL_PLANES; k++)
        copy_floats(from + k * DENOISE_TILE_PIXELS, count,
                    to + (k * tile->rows + row) * tile->pitch + column);
      column += count;
    }
  }
}

/// The normal equations of LANES pixels of a tile at one bandwidth. `weights`: theirs, of all neighbours and
/// then, zeros.
FN void sum_normal(const PRIVATE DenoiseTile* tile, const GLOBAL float* weights, int search_radius,
                   int bandwidth, const GLOBAL float* features, const GLOBAL float* colors, int plane,
                   GLOBAL float* normal) {
  const int neighbours = neighbours_of(search_radius, FIT_STEP);
  NeighbourBatch batch;
  batch.count = 0;
  for (int i = 0; i < NORMAL_ROWS * LANES; i++) normal[i] = 0.0f;
  for (int n = 0; n < neighbours; n++) {
    if (any_weight(weights + n * LANES, bandwidth)) {
      batch.n[batch.count] = n;
      batch.shift[batch.count] = neighbour_shift(tile, search_radius, FIT_STEP, n);
      batch.count++;
    }
    if (batch.count == BATCH) {
      add_neighbours(&batch, weights, bandwidth, features, colors, plane, normal);
      batch.count = 0;
    }
  }
  if (batch.count == 0) return;
  for (int i = batch.count; i < BATCH; i++) {
    batch.n[i] = neighbours;
    batch.shift[i] = 0;
  }
  add_neighbours(&batch, weights, bandwidth, features, colors, plane, normal);
}

/// Fits the models of a tile's pixels. `sources`: the planes of features, then of colours. The
/// models of tile `number` are written.
FN void fit_tile(const GLOBAL DenoiseTask* task, int number, const GLOBAL float* guide,
                 const GLOBAL float* sources, GLOBAL float* scratch, GLOBAL float* models) {
  const DenoiseTile tile = denoise_tile(task, number);
  const int plane = tile.pitch * tile.rows, neighbours = neighbours_of(task->search_radius, FIT_STEP);
  const int kept = neighbours + 1;
  GLOBAL float* normal = scratch + PAIR_SCRATCH;
  GLOBAL float* pair = normal + NORMAL_ROWS * 16;
  // Of each group of LANES pixels: the weights of all neighbours, and then zeros.
  GLOBAL float* weights = pair + 2 * DENOISE_TILE_PIXELS;
  GLOBAL float* tile_guide = weights + kept * DENOISE_TILE_PIXELS;
  GLOBAL float* tile_models = models + (ulong)number * (ulong)tile_model_floats();
  GLOBAL float* features = tile_guide + GUIDE_PLANES * plane;
  GLOBAL float* colors = features + REGRESSION_FEATURES * plane;
  load_guide(task, &tile, guide, tile_guide);
  load_planes(&tile, sources, REGRESSION_FEATURES + REGRESSION_COLORS, task->width, 0, task->height,
              features);
  fill_floats(0.0f, DENOISE_TILE_PIXELS, pair);
  keep_weights(pair, DENOISE_TILE_WIDTH, neighbours, kept, weights);
  keep_all_weights(task, &tile, tile_guide, CENTRE_IS_PIXEL, FIT_STEP, kept, scratch, pair, weights);
  for (int first = 0; first < DENOISE_TILE_PIXELS; first += LANES) {
    const int pixel =
        (tile.border + first / DENOISE_TILE_WIDTH) * tile.pitch + tile.border + first % DENOISE_TILE_WIDTH;
    for (int bandwidth = 0; bandwidth < REGRESSION_BANDWIDTHS; bandwidth++) {
      sum_normal(&tile, weights + first * kept, task->search_radius, bandwidth, features + pixel,
                 colors + pixel, plane, normal);
      solve_normal(normal);
      const int first_plane = bandwidth * REGRESSION_COLORS * REGRESSION_TERMS;
      for (int k = 0; k < REGRESSION_COLORS * REGRESSION_TERMS; k++)
        for (int j = 0; j < LANES; j++)
          tile_models[(first_plane + k) * DENOISE_TILE_PIXELS + first + j] =
              normal[(NORMAL_ENTRIES + k) * LANES + j];
    }
  }
}

FN int predict_scratch_floats(const GLOBAL DenoiseTask* task) {
  const int plane = tile_plane_floats(task);
  return PAIR_SCRATCH +
         DENOISE_TILE_PIXELS *
             (2 + neighbours_of(task->search_radius, 1) + REGRESSION_BANDWIDTHS * (1 + REGRESSION_COLORS)) +
         (GUIDE_PLANES + REGRESSION_FEATURES + MODEL_PLANES) * plane;
}

/// Computes REGRESSION_COLORS planes for each bandwidth. `sources` as for fit_tile.
FN void predict_tile(const GLOBAL DenoiseTask* task, int number, const GLOBAL float* guide,
                     const GLOBAL float* sources, const GLOBAL float* models, GLOBAL float* scratch,
                     GLOBAL float* out) {
  const DenoiseTile tile = denoise_tile(task, number);
  const int plane = tile.pitch * tile.rows, first_pixel = tile.border * tile.pitch + tile.border;
  const int neighbours = neighbours_of(task->search_radius, 1);
  GLOBAL float* pair = scratch + PAIR_SCRATCH;
  GLOBAL float* weights = pair + 2 * DENOISE_TILE_PIXELS;  // of each group of LANES pixels: of all neighbours
  GLOBAL float* weight_sums = weights + neighbours * DENOISE_TILE_PIXELS;
  GLOBAL float* sums = weight_sums + REGRESSION_BANDWIDTHS * DENOISE_TILE_PIXELS;
  GLOBAL float* tile_guide = sums + REGRESSION_BANDWIDTHS * REGRESSION_COLORS * DENOISE_TILE_PIXELS;
  GLOBAL float* features = tile_guide + GUIDE_PLANES * plane;
  GLOBAL float* tile_models = features + REGRESSION_FEATURES * plane;
  load_guide(task, &tile, guide, tile_guide);
  load_planes(&tile, sources, REGRESSION_FEATURES, task->width, 0, task->height, features);
  load_models(task, &tile, models, tile_models);
  fill_floats(0.0f, REGRESSION_BANDWIDTHS * (1 + REGRESSION_COLORS) * DENOISE_TILE_PIXELS, weight_sums);
  keep_all_weights(task, &tile, tile_guide, CENTRE_IS_NEIGHBOUR, 1, neighbours, scratch, pair, weights);
  // All pixels of a row with one row of neighbours after the other, whose models stay in the cache.
  const int side = 2 * task->search_radius + 1;
  for (int row = 0; row < DENOISE_TILE_HEIGHT; row++)
    for (int first_of_row = 0; first_of_row < neighbours; first_of_row += side)
      for (int column = 0; column < DENOISE_TILE_WIDTH; column += LANES) {
        const int pixel = first_pixel + row * tile.pitch + column, at = row * DENOISE_TILE_WIDTH + column;
        for (int n = first_of_row; n < first_of_row + side; n++) {
          const GLOBAL float* of_group = weights + at * neighbours + n * LANES;
          if (any_weight(of_group, REGRESSION_BANDWIDTHS - 1))
            add_prediction(of_group, features + pixel, tile_models + pixel, plane,
                           neighbour_shift(&tile, task->search_radius, 1, n), weight_sums + at, sums + at);
        }
      }
  for (int b = 0; b < REGRESSION_BANDWIDTHS; b++)
    for (int c = 0; c < REGRESSION_COLORS; c++) {
      GLOBAL float* means = sums + (b * REGRESSION_COLORS + c) * DENOISE_TILE_PIXELS;
      // A pixel's own model always has weight, except that of a pixel that does not exist or is not finite.
      for (int row = 0; row < DENOISE_TILE_HEIGHT; row++)
        divide_by_weights(weight_sums + b * DENOISE_TILE_PIXELS + row * DENOISE_TILE_WIDTH,
                          tile_models + (b * REGRESSION_COLORS + c) * REGRESSION_TERMS * plane +
                              (tile.border + row) * tile.pitch + tile.border,
                          means + row * DENOISE_TILE_WIDTH);
      store_tile(task, &tile, means, task->out_row,
                 out + (ulong)(b * REGRESSION_COLORS + c) * (ulong)task->width * (ulong)task->out_rows);
    }
}

PENUMBRA_NAMESPACE_END
#endif
