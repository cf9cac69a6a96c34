// What the kernels of denoising work on: a part of an image, tile by tile.
#ifndef PENUMBRA_DENOISE_TASK_H
#define PENUMBRA_DENOISE_TASK_H
#include "kernels/math/math.h"

PENUMBRA_NAMESPACE_BEGIN

// Tiles begin at fixed places of the image. The result does not depend on them: each pixel is the same sum in
// the same order.
#define DENOISE_TILE_WIDTH 64
#define DENOISE_TILE_HEIGHT 32
#define DENOISE_TILE_PIXELS (DENOISE_TILE_WIDTH * DENOISE_TILE_HEIGHT)

#define MAX_SEARCH_RADIUS 16
#define MAX_PATCH_RADIUS 5
#define MAX_SOURCES 8

// The guide is the image that weights are computed from: three channels, their variances, and a plane that is
// 1 where a pixel exists and is finite, and 0 where it is not.
#define GUIDE_CHANNELS 3
#define GUIDE_PLANES (2 * GUIDE_CHANNELS + 1)
#define VALID_PLANE (2 * GUIDE_CHANNELS)

// First-order regression: a constant and a slope for each feature, for each colour, at two bandwidths.
#define REGRESSION_FEATURES 7
#define REGRESSION_TERMS (1 + REGRESSION_FEATURES)
#define REGRESSION_COLORS 3
#define REGRESSION_BANDWIDTHS 2
#define MODEL_PLANES (REGRESSION_BANDWIDTHS * REGRESSION_COLORS * REGRESSION_TERMS)

enum {
  DENOISE_FILTER,  ///< non-local means of `sources` planes
  DENOISE_FIT,     ///< the models of first-order regression
  DENOISE_PREDICT  ///< the means of what the models of a neighbourhood predict for a pixel
};

/// All images are planes of `width` x `height` floats, row by row. Rows [first_row, end_row) are computed;
/// the planes of models and of results hold rows from `model_row` and `out_row` on only.
typedef struct {
  int stage;
  int width, height;
  int first_row, end_row;
  int model_row, model_rows;  ///< DENOISE_FIT and DENOISE_PREDICT
  int out_row, out_rows;
  int search_radius;  ///< r: (2r+1)^2 neighbours
  int patch_radius;   ///< f: patches of (2f+1)^2 pixels
  int sources;        ///< DENOISE_FILTER: the number of planes to filter
  float strength;     ///< k; the larger, the smoother
} DenoiseTask;

FN int denoise_tiles_across(const GLOBAL DenoiseTask* task) {
  return (task->width + DENOISE_TILE_WIDTH - 1) / DENOISE_TILE_WIDTH;
}
FN int denoise_tiles_of(const GLOBAL DenoiseTask* task) {
  const int rows = task->end_row - task->first_row;
  return denoise_tiles_across(task) * ((rows + DENOISE_TILE_HEIGHT - 1) / DENOISE_TILE_HEIGHT);
}

/// A tile with a border of `border` pixels: its first pixel without the border, and the pitch of its rows,
/// which is a multiple of 16.
typedef struct {
  int x, y;
  int border;
  int pitch, rows;
} DenoiseTile;

FN int denoise_pitch(int border) { return (DENOISE_TILE_WIDTH + 2 * border + 16 + 15) / 16 * 16; }

/// Floats of one plane of a tile with its border.
FN int tile_plane_floats(const GLOBAL DenoiseTask* task) {
  const int border = task->search_radius + task->patch_radius;
  return denoise_pitch(border) * (DENOISE_TILE_HEIGHT + 2 * border);
}

FN DenoiseTile denoise_tile(const GLOBAL DenoiseTask* task, int number) {
  DenoiseTile tile;
  tile.x = number % denoise_tiles_across(task) * DENOISE_TILE_WIDTH;
  tile.y = task->first_row + number / denoise_tiles_across(task) * DENOISE_TILE_HEIGHT;
  tile.border = task->search_radius + task->patch_radius;
  tile.pitch = denoise_pitch(tile.border);
  tile.rows = DENOISE_TILE_HEIGHT + 2 * tile.border;
  return tile;
}

STAGE void copy_floats(const GLOBAL float* RESTRICT from, int count, GLOBAL float* RESTRICT to) {
  LANE_LOOP
    for (int i = 0; i < count; i++) to[i] = from[i];
}

STAGE void fill_floats(float value, int count, GLOBAL float* RESTRICT to) {
  LANE_LOOP
    for (int i = 0; i < count; i++) to[i] = value;
}

/// Copies a tile with its border from a plane that begins with row `first_row` of the image. Pixels outside
/// of the plane are those at its edge, or `outside` if that is not negative.
STAGE void load_plane(const PRIVATE DenoiseTile* tile, const GLOBAL float* RESTRICT plane, int width,
                      int first_row, int rows, float outside, GLOBAL float* RESTRICT to) {
  const int x = tile->x - tile->border, left = min_i(max_i(-x, 0), tile->pitch);
  const int end = max_i(min_i(width - x, tile->pitch), left);
  for (int row = 0; row < tile->rows; row++) {
    const int y = tile->y - tile->border + row - first_row, inside_y = max_i(0, min_i(y, rows - 1));
    const GLOBAL float* from = plane + (ulong)inside_y * (ulong)width;
    GLOBAL float* to_row = to + row * tile->pitch;
    const bool is_outside = (y != inside_y) & (outside >= 0.0f);
    fill_floats(outside >= 0.0f ? outside : from[0], left, to_row);
    if (is_outside)
      fill_floats(outside, end - left, to_row + left);
    else
      copy_floats(from + x + left, end - left, to_row + left);
    fill_floats(outside >= 0.0f ? outside : from[width - 1], tile->pitch - end, to_row + end);
  }
}

/// Loads `count` planes that follow each other, both in the image and in the tile.
FN void load_planes(const PRIVATE DenoiseTile* tile, const GLOBAL float* planes, int count, int width,
                    int first_row, int rows, GLOBAL float* to) {
  for (int k = 0; k < count; k++)
    load_plane(tile, planes + (ulong)k * (ulong)width * (ulong)rows, width, first_row, rows, -1.0f,
               to + k * tile->pitch * tile->rows);
}

/// Loads the guide. Pixels outside of the image are not valid.
FN void load_guide(const GLOBAL DenoiseTask* task, const PRIVATE DenoiseTile* tile, const GLOBAL float* guide,
                   GLOBAL float* to) {
  load_planes(tile, guide, VALID_PLANE, task->width, 0, task->height, to);
  load_plane(tile, guide + (ulong)VALID_PLANE * (ulong)task->width * (ulong)task->height, task->width, 0,
             task->height, 0.0f, to + VALID_PLANE * tile->pitch * tile->rows);
}

/// Copies the tile's rows of a plane without border to a plane that begins with row `first_row` of the image.
STAGE void store_tile(const GLOBAL DenoiseTask* task, const PRIVATE DenoiseTile* tile,
                      const GLOBAL float* RESTRICT from, int first_row, GLOBAL float* RESTRICT plane) {
  const int columns = min_i(DENOISE_TILE_WIDTH, task->width - tile->x);
  const int rows = min_i(DENOISE_TILE_HEIGHT, task->end_row - tile->y);
  for (int row = 0; row < rows; row++)
    copy_floats(from + row * DENOISE_TILE_WIDTH, columns,
                plane + (ulong)(tile->y + row - first_row) * (ulong)task->width + (ulong)tile->x);
}

PENUMBRA_NAMESPACE_END
#endif
