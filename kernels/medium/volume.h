// Grids of numbers in space, and the traversal of a ray through one: from cell to cell of a coarser majorant
// grid, up to the next tentative collision (Woodcock et al. 1965; local majorants: Szirmay-Kalos, Toth and
// Magdics 2011). Where the majorant is far larger than what the ray meets, as beside one very dense cell,
// pieces of the ray have their own majorants.
#ifndef PENUMBRA_VOLUME_H
#define PENUMBRA_VOLUME_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"
#include "kernels/medium/majorant_grid.h"
#include "kernels/sampler/sampler.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// A vector in scene space, in units of the volume's cells.
FN vec3 in_cells(GLOBAL const Volume* v, vec3 way) {
  return make_vec3(dot3(load3(&v->row_x), way), dot3(load3(&v->row_y), way), dot3(load3(&v->row_z), way));
}

/// The position in cell coordinates: inside of the box from 0 to the number of cells.
FN vec3 volume_place(GLOBAL const Volume* v, vec3 p) { return in_cells(v, sub(p, load3(&v->corner))); }

FN vec3 cell_value(const PRIVATE Scene* scene, GLOBAL const Volume* v, int x, int y, int z) {
  const int cell = v->first_value + ((z * v->ny + y) * v->nx + x) * v->channels;
  const int further = v->channels == 3 ? 1 : 0;
  return make_vec3(scene->volume_values[cell], scene->volume_values[cell + further],
                   scene->volume_values[cell + 2 * further]);
}

FN vec3 between3(vec3 a, vec3 b, float share) { return add_scaled(a, share, sub(b, a)); }

/// The share of an outermost cell's value at a position along one axis of a grid that fades: interpolation
/// between it and the 0 of the next cell outside.
FN float fading(float place, int cells) {
  return clamp_f(min_f(place, (float)cells - place) + 0.5f, 0.0f, 1.0f);
}

/// The value at a position in cell coordinates: that of the cell, or interpolated between the eight nearest
/// cell centres. Positions beyond the outermost centres take their values, or less where the grid fades.
FN vec3 volume_value(const PRIVATE Scene* scene, GLOBAL const Volume* v, vec3 place) {
  const float shift = v->nearest != 0 ? 0.0f : 0.5f;
  const float x = clamp_f(place.x - shift, 0.0f, (float)(v->nx - 1)),
              y = clamp_f(place.y - shift, 0.0f, (float)(v->ny - 1)),
              z = clamp_f(place.z - shift, 0.0f, (float)(v->nz - 1));
  const int x0 = (int)x, y0 = (int)y, z0 = (int)z;
  if (v->nearest != 0) return cell_value(scene, v, x0, y0, z0);
  const int x1 = min_i(x0 + 1, v->nx - 1), y1 = min_i(y0 + 1, v->ny - 1), z1 = min_i(z0 + 1, v->nz - 1);
  const float fx = x - (float)x0, fy = y - (float)y0, fz = z - (float)z0;
  const vec3 near_low = between3(cell_value(scene, v, x0, y0, z0), cell_value(scene, v, x1, y0, z0), fx);
  const vec3 near_high = between3(cell_value(scene, v, x0, y1, z0), cell_value(scene, v, x1, y1, z0), fx);
  const vec3 far_low = between3(cell_value(scene, v, x0, y0, z1), cell_value(scene, v, x1, y0, z1), fx);
  const vec3 far_high = between3(cell_value(scene, v, x0, y1, z1), cell_value(scene, v, x1, y1, z1), fx);
  const vec3 value = between3(between3(near_low, near_high, fy), between3(far_low, far_high, fy), fz);
  if (v->fades == 0) return value;
  return scale(value, fading(place.x, v->nx) * fading(place.y, v->ny) * fading(place.z, v->nz));
}

/// The traversal of a ray through a volume.
typedef struct {
  vec3 place, step;               ///< in cell coordinates: its start, and the step per scene unit
  float t, end;                   ///< current distance, and the exit, in scene units from the start
  float left;                     ///< optical depth, by the majorants, until the next collision
  float majorant;                 ///< of the extinction at the current position, per scene unit
  float piece_end, piece_length;  ///< the piece with this majorant, if a cell is divided into pieces
  int x, y, z;                    ///< the current cell of the majorant grid
  uint random;                    ///< state of its random numbers
} VolumeWalk;

FN float next_number(PRIVATE VolumeWalk* walk) {
  walk->random = hash_uint(walk->random + 0x9e3779b9u);
  return unit_float(walk->random);
}

FN vec3 walk_place(const PRIVATE VolumeWalk* walk) { return add_scaled(walk->place, walk->t, walk->step); }

/// Clips [*from, *to] to where the coordinate place + t * step is in [0, size].
FN void clip_to_slab(float place, float step, float size, PRIVATE float* from, PRIVATE float* to) {
  if (step == 0.0f) {
    const bool inside = (place >= 0.0f) & (place <= size);
    *to = inside ? *to : -1.0f;
    return;
  }
  const float a = -place / step, b = (size - place) / step;
  *from = max_f(*from, min_f(a, b));
  *to = min_f(*to, max_f(a, b));
}

FN int coarse_cell(float place, int cells) {
  return (int)clamp_f(place * (1.0f / (float)MAJORANT_CELLS), 0.0f, (float)(majorant_cells(cells) - 1));
}

FN VolumeWalk start_walk(GLOBAL const Volume* v, vec3 origin, vec3 direction, float length, float left,
                         uint random) {
  VolumeWalk walk;
  walk.place = volume_place(v, origin);
  walk.step = in_cells(v, direction);
  walk.t = 0.0f;
  walk.end = length;
  clip_to_slab(walk.place.x, walk.step.x, (float)v->nx, &walk.t, &walk.end);
  clip_to_slab(walk.place.y, walk.step.y, (float)v->ny, &walk.t, &walk.end);
  clip_to_slab(walk.place.z, walk.step.z, (float)v->nz, &walk.t, &walk.end);
  const vec3 enters = walk_place(&walk);
  walk.x = coarse_cell(enters.x, v->nx);
  walk.y = coarse_cell(enters.y, v->ny);
  walk.z = coarse_cell(enters.z, v->nz);
  walk.left = left;
  walk.majorant = 0.0f;
  walk.piece_end = 0.0f;
  walk.piece_length = NO_LIMIT;
  walk.random = random;
  return walk;
}

/// The distance from the ray's start at which a coordinate leaves the cell of the majorant grid.
FN float leaves_cell(float place, float step, int cell) {
  const float side = (float)(MAJORANT_CELLS * (step > 0.0f ? cell + 1 : cell));
  return step == 0.0f ? NO_LIMIT : (side - place) / step;
}

// The largest optical depth of a piece, by its majorant: about the number of null collisions within it.
#define MOST_PIECE_DEPTH 64.0f

/// The maximum between two positions in the same cell. Interpolation is linear along each axis, so the
/// maximum is at a corner of the box between the positions.
FN float largest_between(const PRIVATE Scene* scene, GLOBAL const Volume* v, vec3 a, vec3 b) {
  float most = 0.0f;
  for (int corner = 0; corner < 8; corner++) {
    const vec3 place = make_vec3((corner & 1) != 0 ? b.x : a.x, (corner & 2) != 0 ? b.y : a.y,
                                 (corner & 4) != 0 ? b.z : a.z);
    most = max_f(most, max_component(volume_value(scene, v, place)));
  }
  return most;
}

/// The distance at which a coordinate of a ray at `t` next crosses a cell boundary, or a cell centre if
/// values are interpolated.
FN float leaves_fine_cell(float place, float step, float t, float shift) {
  const float at = floor_f(place + t * step - shift);
  const float next = (at + (step > 0.0f ? 1.0f : 0.0f) + shift - place) / step;
  const float after = (at + (step > 0.0f ? 2.0f : -1.0f) + shift - place) / step;
  return step == 0.0f ? NO_LIMIT : (next > t ? next : after);
}

/// A distance that is larger by little more than the rounding error.
FN float next_distance(float t) { return t + t * 1.2e-7f; }

/// Begins a piece of the ray at its current position, which ends at `exit` or before. Its optical depth by
/// its own majorant is at most MOST_PIECE_DEPTH, if floats can distinguish its ends.
FN void begin_piece(const PRIVATE Scene* scene, GLOBAL const Volume* v, float strongest, float exit,
                    PRIVATE VolumeWalk* walk) {
  const float shift = v->nearest != 0 ? 0.0f : 0.5f;
  const float least = next_distance(walk->t) - walk->t;
  const float leaves = min_f(leaves_fine_cell(walk->place.x, walk->step.x, walk->t, shift),
                             min_f(leaves_fine_cell(walk->place.y, walk->step.y, walk->t, shift),
                                   leaves_fine_cell(walk->place.z, walk->step.z, walk->t, shift)));
  const vec3 from = walk_place(walk);
  // The length of the last piece is a good first guess.
  float length = max_f(min_f(min_f(leaves, exit) - walk->t, 4.0f * walk->piece_length), least);
  for (;;) {
    const vec3 to = add_scaled(walk->place, walk->t + length, walk->step);
    walk->majorant = strongest * largest_between(scene, v, from, to);
    if (walk->majorant * length <= MOST_PIECE_DEPTH || length <= 2.0f * least || length < 1e-30f) break;
    length *= 0.5f;
  }
  walk->piece_length = length;
  walk->piece_end = min_f(walk->t + length, exit);
}

FN float cell_majorant(const PRIVATE Scene* scene, GLOBAL const Volume* v, const PRIVATE VolumeWalk* walk) {
  const int mx = majorant_cells(v->nx), my = majorant_cells(v->ny);
  return scene->majorants[v->first_majorant + (walk->z * my + walk->y) * mx + walk->x];
}

/// Enters the next cell of the majorant grid. `at_x`, `at_y`: the distances at which these coordinates
/// leave the current one; `nearest`: the least of all. Returns false if the ray leaves the grid.
FN bool enter_next_cell(GLOBAL const Volume* v, float at_x, float at_y, float nearest,
                        PRIVATE VolumeWalk* walk) {
  // One axis at a time, so that the loop ends despite rounding.
  if (at_x <= nearest)
    walk->x += walk->step.x > 0.0f ? 1 : -1;
  else if (at_y <= nearest)
    walk->y += walk->step.y > 0.0f ? 1 : -1;
  else
    walk->z += walk->step.z > 0.0f ? 1 : -1;
  return (walk->x >= 0) & (walk->x < majorant_cells(v->nx)) & (walk->y >= 0) &
         (walk->y < majorant_cells(v->ny)) & (walk->z >= 0) & (walk->z < majorant_cells(v->nz));
}

/// The integral of the majorants over the rest of the walk.
FN float majorant_integral(const PRIVATE Scene* scene, GLOBAL const Volume* v, VolumeWalk walk) {
  float sum = 0.0f;
  while (walk.t < walk.end) {
    const float at_x = leaves_cell(walk.place.x, walk.step.x, walk.x),
                at_y = leaves_cell(walk.place.y, walk.step.y, walk.y),
                at_z = leaves_cell(walk.place.z, walk.step.z, walk.z);
    const float nearest = min_f(at_x, min_f(at_y, at_z)), exit = max_f(min_f(nearest, walk.end), walk.t);
    sum += cell_majorant(scene, v, &walk) * (exit - walk.t);
    walk.t = exit;
    if (!enter_next_cell(v, at_x, at_y, nearest, &walk)) return sum;
  }
  return sum;
}

/// Advances to the next tentative collision with the volume's numbers times `strongest`. Returns false if the
/// ray leaves, or the walk ends, first. A walk whose `end` is later then set further on continues.
FN bool next_collision(const PRIVATE Scene* scene, GLOBAL const Volume* v, float strongest,
                       PRIVATE VolumeWalk* walk) {
  while (walk->t < walk->end) {
    const float at_x = leaves_cell(walk->place.x, walk->step.x, walk->x),
                at_y = leaves_cell(walk->place.y, walk->step.y, walk->y),
                at_z = leaves_cell(walk->place.z, walk->step.z, walk->z);
    const float nearest = min_f(at_x, min_f(at_y, at_z)), exit = max_f(min_f(nearest, walk->end), walk->t);
    const float majorant = strongest * cell_majorant(scene, v, walk);
    const bool in_pieces = majorant * (exit - walk->t) > MOST_PIECE_DEPTH;
    float to = exit;
    if (in_pieces) {
      if (!(walk->t < walk->piece_end)) begin_piece(scene, v, strongest, exit, walk);
      to = walk->piece_end;
    } else {
      walk->majorant = majorant;
    }
    const float depth = walk->majorant * (to - walk->t);
    if (walk->left < depth) {
      const float at = walk->t + walk->left / walk->majorant;
      // If floats cannot distinguish successive collisions, the ray still advances.
      walk->t = min_f(in_pieces && !(at > walk->t) ? next_distance(at) : at, to);
      return true;
    }
    walk->left -= depth;
    walk->t = to;
    if (to < exit) continue;
    if (exit < nearest || !enter_next_cell(v, at_x, at_y, nearest, walk)) return false;
  }
  return false;
}

PENUMBRA_NAMESPACE_END
#endif
