// Density estimates: the light that photons bring to the surfaces and points in media where LANES paths of
// the camera are (Jensen 1996; progressive: Knaus and Zwicker 2011). The photons within the radius of a point
// arrive in a disk, or in media in a ball, of constant weight. Their sums are in the order of the map, so
// that they are the same on every machine.
#ifndef PENUMBRA_PHOTON_GATHER_H
#define PENUMBRA_PHOTON_GATHER_H
#include "kernels/bsdf/bsdf.h"
#include "kernels/photon/photon_map.h"
#include "kernels/photon/photon_surfaces.h"

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
  int k, end;  ///< the rest of the range before it
  uint near;   ///< the photons before k that are still to be returned: bit j for k - 8 + j
} PhotonSearch;

FN PhotonSearch search_photons(const PRIVATE PhotonTable* table, Surface s, int most_edges) {
  const float radius = table->map.radius;
  PhotonSearch search;
  search.p = s.p;
  search.normal = s.geometric;
  search.in_medium = s.primitive == IN_MEDIUM;
  search.most_edges = most_edges;
  search.radius2 = sqr(radius);
  search.lowest = photon_cell(sub(s.p, make_vec3(radius, radius, radius)), table->map.cells);
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

// Photons whose BSDF values are still to be computed, for LANES pairs of a path and a photon.
typedef struct {
  Surfaces surfaces;
  Closures closures;
  float wi[3 * LANES];
  float power[3 * LANES];
  int lane[LANES];
  int count;
} PhotonPairs;

/// Adds the light of the pairs to `sums`, a lane vec3.
FN void finish_pairs(const PRIVATE Scene* scene, uint families, PRIVATE PhotonPairs* pairs,
                     PRIVATE float* sums) {
  BsdfValues values;
  if (pairs->count == 0) return;
  for (int q = pairs->count; q < LANES; q++) {
    store_surface(&pairs->surfaces, q, load_surface(&pairs->surfaces, 0));
    store_closure(&pairs->closures, q, load_closure(&pairs->closures, 0));
    STORE_LANE_vec3(pairs->wi, q, LOAD_LANE_vec3(pairs->wi, 0));
  }
  eval_bsdfs(scene, families, &pairs->closures, &pairs->surfaces, pairs->wi, &values);
  for (int q = 0; q < pairs->count; q++) {
    const Surface s = load_surface(&pairs->surfaces, q);
    const vec3 wi = LOAD_LANE_vec3(pairs->wi, q);
    const bool in_medium = s.primitive == IN_MEDIUM;
    const float cosine = max_f(FABS(dot3(s.geometric, wi)), LEAST_ARRIVAL_COSINE);
    const bool lit = in_medium | !is_beneath(s, wi);
    const vec3 f = scale(LOAD_LANE_vec3(values.f_cos, q), in_medium ? 1.0f : 1.0f / cosine);
    const vec3 light = mul(f, LOAD_LANE_vec3(pairs->power, q));
    const int j = pairs->lane[q];
    STORE_LANE_vec3(sums, j, add(LOAD_LANE_vec3(sums, j), select3(lit, light, make_vec3(0.0f, 0.0f, 0.0f))));
  }
  pairs->count = 0;
}

FN void add_pair(const PRIVATE Scene* scene, uint families, const PRIVATE Surfaces* surfaces,
                 const PRIVATE Closures* closures, int j, vec3 wi, vec3 power, PRIVATE PhotonPairs* pairs,
                 PRIVATE float* sums) {
  const int q = pairs->count++;
  store_surface(&pairs->surfaces, q, load_surface(surfaces, j));
  store_closure(&pairs->closures, q, load_closure(closures, j));
  STORE_LANE_vec3(pairs->wi, q, wi);
  STORE_LANE_vec3(pairs->power, q, power);
  pairs->lane[q] = j;
  if (pairs->count == LANES) finish_pairs(scene, families, pairs, sums);
}

/// Photon i of a surface of the diffuse family: its light without the reflectance over pi.
FN vec3 diffuse_light(const PRIVATE PhotonTable* table, Surface s, int i) {
  const vec3 wi = photon_vector(table, table->wi, i);
  const float cosine = dot3(s.shading, wi), arrival = dot3(s.geometric, wi);
  const bool lit = (cosine > 0.0f) & (arrival > 0.0f);
  return scale(photon_vector(table, table->powers, i),
               lit ? cosine / max_f(arrival, LEAST_ARRIVAL_COSINE) : 0.0f);
}

/// 1 / the extent of an estimate: a disk, or in media a ball.
FN float inverse_extent(bool in_medium, float radius2) {
  return in_medium ? 3.0f / (4.0f * PI_F * radius2 * SQRT(radius2)) : 1.0f / (PI_F * radius2);
}

/// The photons of one map that LANES paths look up.
typedef struct {
  int map;                ///< PHOTON_MAP_*
  int lookup_size;        ///< about so many of the nearest; 0: all within the radius
  int wanted[LANES];      ///< 1: the lane has an estimate
  int most_edges[LANES];  ///< of photons
} PhotonRequest;

/// Adds to `sums`, a lane vec3, the radiance that photons scatter towards wo; in media over the scattering
/// coefficient, which is part of the path's weight.
STAGE void gather_photons(const PRIVATE Scene* scene, const PRIVATE PhotonRequest* request,
                          const PRIVATE Surfaces* surfaces, const PRIVATE Closures* closures, uint families,
                          PRIVATE float* sums) {
  const PhotonTable table = photon_table(scene->photons, request->map);
  float found[3 * LANES], weights[LANES];
  PhotonPairs pairs;
  pairs.count = 0;
  for (int j = 0; j < LANES; j++) {
    STORE_LANE_vec3(found, j, make_vec3(0.0f, 0.0f, 0.0f));
    weights[j] = 0.0f;
    if (request->wanted[j] == 0 || table.map.count == 0) continue;
    const Surface s = load_surface(surfaces, j);
    PhotonSearch search = search_photons(&table, s, request->most_edges[j]);
    if (request->lookup_size > 0 && request->lookup_size < table.map.count)
      search.radius2 = squared_lookup_radius(&table, search, request->lookup_size);
    weights[j] = table.map.share * inverse_extent(search.in_medium, search.radius2);
    const bool diffuse = closures->family[j] == FAMILY_DIFFUSE;
    vec3 light = make_vec3(0.0f, 0.0f, 0.0f);
    for (int i = next_photon(&table, &search); i >= 0; i = next_photon(&table, &search)) {
      if (diffuse)
        light = add(light, diffuse_light(&table, s, i));
      else
        add_pair(scene, families, surfaces, closures, j, photon_vector(&table, table.wi, i),
                 photon_vector(&table, table.powers, i), &pairs, found);
    }
    if (diffuse) STORE_LANE_vec3(found, j, mul(scale(LOAD_LANE_vec3(closures->diffuse, j), INV_PI_F), light));
  }
  finish_pairs(scene, families, &pairs, found);
  for (int j = 0; j < LANES; j++)
    STORE_LANE_vec3(sums, j, add_scaled(LOAD_LANE_vec3(sums, j), weights[j], LOAD_LANE_vec3(found, j)));
}

PENUMBRA_NAMESPACE_END
#endif
