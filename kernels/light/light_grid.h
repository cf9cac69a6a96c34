// Importance sampling of textured lights by a grid. Each kind of light maps two numbers (u, v) to a point
// that is uniform by area. For a light with a grid, the unit square of (u, v) is divided into grid_side x
// grid_side cells; a cell is chosen by its share of the light's power, then a position in the cell. So the
// pdf is that of uniform sampling times a step function. It can also be evaluated at a point that a ray hits,
// by inverting the mapping.
//
// Table of a light: the cumulative shares of the rows (cells in u), from 0 to 1 (grid_side + 1 numbers); then
// for each row those of its cells in v. All are multiples of 2^-24, like the numbers of samplers, so that
// differences are exact probabilities.
#ifndef PENUMBRA_LIGHT_GRID_H
#define PENUMBRA_LIGHT_GRID_H
#include "kernels/intersect/surface_uv.h"
#include "kernels/light/light_found.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  float u, v;
  float density;  ///< relative to uniform sampling by area
} GridPoint;

/// Cumulative share k of a row of cells; the row starts at `first` in the table.
FN float grid_edge(const PRIVATE Scene* scene, int first, int k) { return scene->light_grids[first + k]; }

/// The cell of a row that x in [0, 1) selects.
FN int grid_cell(const PRIVATE Scene* scene, int first, int side, float x) {
  int cell = 0, size = side;
  UNROLL
  for (int k = 0; k < LIGHT_GRID_STEPS; k++) {
    const int half_size = size >> 1, middle = cell + half_size;
    const bool above = (half_size > 0) & (grid_edge(scene, first, middle) <= x);
    cell = above ? middle : cell;
    size = above ? size - half_size : (half_size > 0 ? half_size : size);
  }
  return cell;
}

/// Maps numbers in [0, 1) to those that select a point of a light with a grid. The result is arbitrary for
/// other lights.
FN GridPoint sample_light_grid(const PRIVATE Scene* scene, GLOBAL const Light* light, float u, float v) {
  const bool has_grid = light->grid >= 0;
  const int side = has_grid ? light->grid_side : 0, rows = has_grid ? light->grid : 0;
  const float cells = (float)(side > 0 ? side : 1);
  const int row = grid_cell(scene, rows, side, u);
  const float from_u = grid_edge(scene, rows, row), share_u = grid_edge(scene, rows, row + 1) - from_u;
  const int columns = rows + (row + 1) * (side + 1);
  const int column = grid_cell(scene, columns, side, v);
  const float from_v = grid_edge(scene, columns, column);
  const float share_v = grid_edge(scene, columns, column + 1) - from_v;
  const float in_u = clamp_f((u - from_u) / (share_u > 0.0f ? share_u : 1.0f), 0.0f, 1.0f);
  const float in_v = clamp_f((v - from_v) / (share_v > 0.0f ? share_v : 1.0f), 0.0f, 1.0f);
  GridPoint p;
  p.u = min_f(((float)row + in_u) / cells, ONE_MINUS_EPSILON);
  p.v = min_f(((float)column + in_v) / cells, ONE_MINUS_EPSILON);
  p.density = (share_u * cells) * (share_v * cells);
  return p;
}

/// The density at the point of these numbers, relative to uniform sampling.
FN float light_grid_density(const PRIVATE Scene* scene, GLOBAL const Light* light, float u, float v) {
  const bool has_grid = light->grid >= 0;
  const int side = has_grid ? light->grid_side : 0, rows = has_grid ? light->grid : 0;
  const float cells = (float)side;
  const int row = (int)(clamp_f(u, 0.0f, ONE_MINUS_EPSILON) * cells);
  const int column = (int)(clamp_f(v, 0.0f, ONE_MINUS_EPSILON) * cells);
  const int columns = rows + (row + 1) * (side + 1);
  const float share_u = grid_edge(scene, rows, row + 1) - grid_edge(scene, rows, row);
  const float share_v = grid_edge(scene, columns, column + 1) - grid_edge(scene, columns, column);
  return (share_u * cells) * (share_v * cells);
}

/// The numbers with which sample_triangle_light, sample_disk_light or sample_sphere_light would sample this
/// point: the inverse of the mapping.
FN TexturePoint numbers_of_light_point(Light light, vec3 p) {
  const vec3 p0 = light.p0, p1 = light.p1, p2 = light.p2;
  const bool triangle = light.kind == LIGHT_TRIANGLE, disk = light.kind == LIGHT_DISK;
  const Barycentric b = barycentric_among(p0, p1, p2, p);
  const float root = 1.0f - b.b0;
  const vec3 from_center = sub(p, p0);
  const vec3 on_disk = to_frame(select3(disk, p1, make_vec3(0.0f, 0.0f, 1.0f)), from_center);
  const float radius = triangle ? 1.0f : p2.x;
  const float turns = turns_of(on_disk.x, on_disk.y);
  const float of_disk = (sqr(on_disk.x) + sqr(on_disk.y)) / sqr(radius);
  const float of_sphere = 0.5f - 0.5f * (from_center.z / radius);
  TexturePoint t;
  t.u = triangle ? sqr(root) : (disk ? of_disk : of_sphere);
  t.v = triangle ? b.b1 / (root > 0.0f ? root : 1.0f) : turns;
  return t;
}

PENUMBRA_NAMESPACE_END
#endif
