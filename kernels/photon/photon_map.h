// A photon map: photons sorted by the cells of a grid (Jensen 1996; the hash of cells after Teschner et al.
// 2003). A cell is longer than the diameter of a density estimate, so that the photons of an estimate lie in
// 2 x 2 x 2 cells. Cells that are neighbours in x are neighbouring buckets. Several cells may share a bucket:
// a search takes a photon only for its own cell, and so never takes it twice.
#ifndef PENUMBRA_PHOTON_MAP_H
#define PENUMBRA_PHOTON_MAP_H
#include "kernels/math/math.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

#define MOST_CELLS 65536.0f  // along an axis on each side of the origin: single precision tells them apart
#define CELL_MARGIN 1.05f    // a cell over the diameter of an estimate, for rounding

// The words of a photon in a map: positions, directions, normals, powers; edges.
#define PHOTON_WORDS 13

typedef struct {
  int x, y, z;
} PhotonCell;

FN int cell_coordinate(float x, float cells) {
  return (int)floor_f(clamp_f(x * cells, -2.0f * MOST_CELLS, 2.0f * MOST_CELLS));
}
FN PhotonCell photon_cell(vec3 p, float cells) {
  PhotonCell cell;
  cell.x = cell_coordinate(p.x, cells);
  cell.y = cell_coordinate(p.y, cells);
  cell.z = cell_coordinate(p.z, cells);
  return cell;
}

/// 1 / the side of the cells for estimates of that radius, in a scene of that size about the origin.
FN float cells_per_unit(float radius, float scene_radius) {
  return 1.0f / max_f(2.0f * CELL_MARGIN * radius, scene_radius / MOST_CELLS);
}

/// The bucket of a cell; `buckets` is a power of two.
FN int photon_bucket(PhotonCell cell, int buckets) {
  const uint row = ((uint)cell.y * 0x9e3779b1u) ^ ((uint)cell.z * 0x85ebca6bu);
  return (int)(((row ^ (row >> 15)) + (uint)cell.x) & (uint)(buckets - 1));
}

/// The arrays of a map, see PHOTON_MAP_FIELDS.
typedef struct {
  PhotonMap map;
  GLOBAL const float* p;
  GLOBAL const float* wi;
  GLOBAL const float* normals;
  GLOBAL const float* powers;
  GLOBAL const int* edges;
  GLOBAL const int* starts;
} PhotonTable;

FN PhotonTable photon_table(GLOBAL const uint* words, int index) {
  PhotonTable t;
  t.map = ((GLOBAL const PhotonMap*)words)[index];
  const int n = t.map.count;
  GLOBAL const float* first = (GLOBAL const float*)(words + t.map.offset);
  t.p = first;
  t.wi = first + 3 * n;
  t.normals = first + 6 * n;
  t.powers = first + 9 * n;
  t.edges = (GLOBAL const int*)(first + 12 * n);
  t.starts = t.edges + n;
  return t;
}

/// Whether no photons arrived, rather than only some that are not finite.
FN bool is_empty_map(GLOBAL const uint* words, int index) {
  GLOBAL const PhotonMap* map = (GLOBAL const PhotonMap*)words + index;
  return (map->count == 0) & (map->share >= 0.0f);
}

PENUMBRA_NAMESPACE_END
#endif
