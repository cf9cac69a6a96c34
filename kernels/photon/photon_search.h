// Searches of a photon map: the photons near a point that belong to the same surface, in the order of the
// map.
#ifndef PENUMBRA_PHOTON_SEARCH_H
#define PENUMBRA_PHOTON_SEARCH_H
#include "kernels/intersect/surface_fields.h"
#include "kernels/photon/photon_map.h"

PENUMBRA_NAMESPACE_BEGIN

// Photons of another surface: their normal deviates by more than this cosine, or they are farther from the
// tangent plane than this share of the radius. Both matter less and less as radii shrink.
#define SAME_NORMAL 0.7f
#define SAME_PLANE 0.25f
// Photons that arrive at a smaller cosine are taken as if at this one, where shading normals would make their
// weight unbounded.
#define LEAST_ARRIVAL_COSINE 1e-3f

/// A search for photons: the point, what they must have in common with it, and how far the search is.
typedef struct {
  vec3 p, normal;
  bool in_medium;
  int most_edges;
  float radius2;
  PhotonCell lowest;  ///< of the 2 x 2 x 2 cells
  int range;   ///< the next range of photons, of 8: two for each pair of cells that are neighbours in x
  int k, end;  ///< photons of the range that are not yet tested
  uint near;   ///< the photons before k that are still to be returned: bit j for k - 8 + j
} PhotonSearch;

/// `normal`: of the surface; not used in media.
FN PhotonSearch search_photons(const PRIVATE PhotonTable* table, vec3 p, vec3 normal, bool in_medium,
                               int most_edges) {
  const float radius = table->map.radius;
  PhotonSearch search;
  search.p = p;
  search.normal = normal;
  search.in_medium = in_medium;
  search.most_edges = most_edges;
  search.radius2 = sqr(radius);
  search.lowest = photon_cell(sub(p, make_vec3(radius, radius, radius)), table->map.cells);
  search.range = search.k = search.end = 0;
  search.near = 0u;
  return search;
}

/// The first of the two cells that are neighbours in x.
FN PhotonCell searched_cell(const PRIVATE PhotonSearch* search, int range) {
  PhotonCell cell = search->lowest;
  cell.y += (range >> 1) & 1;
  cell.z += range >> 2;
  return cell;
}

/// The next range: the buckets of two neighbouring cells. They may wrap around the table; the second range of
/// a pair is empty otherwise.
FN void next_range(const PRIVATE PhotonTable* table, PRIVATE PhotonSearch* search) {
  const int bucket = photon_bucket(searched_cell(search, search->range), table->map.buckets);
  const bool wraps = bucket + 1 == table->map.buckets, second = (search->range & 1) != 0;
  search->k = second ? 0 : table->starts[bucket];
  search->end = table->starts[second ? (wraps ? 1 : 0) : bucket + (wraps ? 1 : 2)];
  search->range++;
}

/// Of the photons k ... k + 7 those that the search takes: bit j of the result.
FN uint near_photons(const PRIVATE PhotonTable* table, const PRIVATE PhotonSearch* search) {
  int near[8];
  const int n = table->map.count;
  const float cells = table->map.cells;
  const PhotonSearch s = *search;
  const PhotonCell cell = searched_cell(search, search->range - 1);
  GLOBAL const float* p = table->p + s.k;
  GLOBAL const float* normals = table->normals + s.k;
  GLOBAL const int* edges = table->edges + s.k;
  // Reads beyond the range, and beyond an array, stay within the map.
  REGISTER_LOOP(8)
  for (int j = 0; j < 8; j++) {
    const vec3 at = make_vec3(p[j], p[n + j], p[2 * n + j]), d = sub(at, s.p);
    const vec3 normal = make_vec3(normals[j], normals[n + j], normals[2 * n + j]);
    const PhotonCell own = photon_cell(at, cells);
    const bool in_row = (own.y == cell.y) & (own.z == cell.z) & ((own.x == cell.x) | (own.x == cell.x + 1));
    const float off = dot3(d, s.normal);
    const bool on_surface =
        (FABS(dot3(normal, s.normal)) > SAME_NORMAL) & (sqr(off) <= sqr(SAME_PLANE) * s.radius2);
    const bool taken = (s.k + j < s.end) & (dot3(d, d) <= s.radius2) & in_row & (s.in_medium | on_surface) &
                       (edges[j] <= s.most_edges);
    near[j] = taken ? 1 : 0;
  }
  return mask_of_8(near);
}

/// The next photon of the search, or -1.
FN int next_photon(const PRIVATE PhotonTable* table, PRIVATE PhotonSearch* search) {
  while (search->near == 0u) {
    if (search->k < search->end) {
      search->near = near_photons(table, search);
      search->k += 8;
    } else {
      if (search->range == 8) return -1;
      next_range(table, search);
    }
  }
  const int i = search->k - 8 + LOWEST_BIT(search->near);
  search->near &= search->near - 1u;
  return i;
}

FN vec3 photon_vector(const PRIVATE PhotonTable* table, GLOBAL const float* array, int i) {
  const int n = table->map.count;
  return make_vec3(array[i], array[n + i], array[2 * n + i]);
}

// The number of rings of equal area that a search for the nearest photons tells apart.
#define LOOKUP_RINGS 64

/// The squared radius of a search that finds about `wanted` photons, at most the map's.
FN float squared_lookup_radius(const PRIVATE PhotonTable* table, PhotonSearch search, int wanted) {
  int rings[LOOKUP_RINGS];
  for (int ring = 0; ring < LOOKUP_RINGS; ring++) rings[ring] = 0;
  for (int i = next_photon(table, &search); i >= 0; i = next_photon(table, &search)) {
    const vec3 d = sub(photon_vector(table, table->p, i), search.p);
    rings[min_i((int)(dot3(d, d) / search.radius2 * (float)LOOKUP_RINGS), LOOKUP_RINGS - 1)]++;
  }
  int ring = 0;
  for (int sum = rings[0]; sum < wanted && ring + 1 < LOOKUP_RINGS; sum += rings[ring]) ring++;
  return search.radius2 * ((float)(ring + 1) / (float)LOOKUP_RINGS);
}

/// Photon i on a diffuse surface: its irradiance, times the area of the estimate. `shading`: the surface's
/// shading normal.
FN vec3 photon_irradiance(const PRIVATE PhotonTable* table, const PRIVATE PhotonSearch* search, vec3 shading,
                          int i) {
  const vec3 wi = photon_vector(table, table->wi, i);
  const float cosine = dot3(shading, wi), arrival = dot3(search->normal, wi);
  const bool lit = (cosine > 0.0f) & (arrival > 0.0f);
  return scale(photon_vector(table, table->powers, i),
               lit ? cosine / max_f(arrival, LEAST_ARRIVAL_COSINE) : 0.0f);
}

/// 1 / the extent of an estimate: a disk, or in media a ball.
FN float inverse_extent(bool in_medium, float radius2) {
  return in_medium ? 3.0f / (4.0f * PI_F * radius2 * SQRT(radius2)) : 1.0f / (PI_F * radius2);
}

/// The nearest photon of the search that is on the same side of the surface, or -1.
FN int nearest_photon(const PRIVATE PhotonTable* table, PhotonSearch search) {
  int nearest = -1;
  float least = 0.0f;
  for (int i = next_photon(table, &search); i >= 0; i = next_photon(table, &search)) {
    const vec3 d = sub(photon_vector(table, table->p, i), search.p);
    const bool same_side = dot3(photon_vector(table, table->normals, i), search.normal) > 0.0f;
    const bool nearer = same_side & ((nearest < 0) | (dot3(d, d) < least));
    least = nearer ? dot3(d, d) : least;
    nearest = nearer ? i : nearest;
  }
  return nearest;
}

PENUMBRA_NAMESPACE_END
#endif
