// Density estimates: the light that photons bring to the surfaces and points in media where LANES paths of
// the camera are (Jensen 1996; progressive: Knaus and Zwicker 2011). The photons within the radius of a point
// arrive in a disk, or in media in a ball, of constant weight. Their sums are in the order of the map, so
// that they are the same on every machine.
#ifndef PENUMBRA_PHOTON_GATHER_H
#define PENUMBRA_PHOTON_GATHER_H
#include "kernels/bsdf/bend_normal.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/photon/photon_search.h"
#include "kernels/photon/photon_surfaces.h"

PENUMBRA_NAMESPACE_BEGIN

// Photons whose BSDF values are still to be computed, for LANES pairs of a path and a photon. Slots keep the
// path of their last pair (its lane, or -1), so that many photons of one path are quick to add.
typedef struct {
  Surfaces surfaces;
  Closures closures;
  float wi[3 * LANES];
  float power[3 * LANES];
  int lane[LANES];
  int count;
} PhotonPairs;

FN void start_pairs(PRIVATE PhotonPairs* pairs) {
  for (int q = 0; q < LANES; q++) pairs->lane[q] = -1;
  pairs->count = 0;
}

/// Adds the light of the pairs to `sums`, a lane vec3.
FN void finish_pairs(const PRIVATE Scene* scene, ulong families, PRIVATE PhotonPairs* pairs,
                     PRIVATE float* sums) {
  BsdfValues values;
  if (pairs->count == 0) return;
  for (int q = pairs->count; q < LANES; q++) {
    store_surface(&pairs->surfaces, q, load_surface(&pairs->surfaces, 0));
    store_closure(&pairs->closures, q, load_closure(&pairs->closures, 0));
    STORE_LANE_vec3(pairs->wi, q, LOAD_LANE_vec3(pairs->wi, 0));
    pairs->lane[q] = pairs->lane[0];
  }
  eval_bsdfs(scene, families, &pairs->closures, &pairs->surfaces, pairs->wi, &values);
  for (int q = 0; q < pairs->count; q++) {
    const Surface s = load_surface(&pairs->surfaces, q);
    const vec3 wi = LOAD_LANE_vec3(pairs->wi, q);
    const bool in_medium = s.primitive == IN_MEDIUM;
    const float cosine = max_f(FABS(dot3(s.geometric, wi)), LEAST_ARRIVAL_COSINE);
    const bool lit = in_medium | !is_beneath(s, wi);
    const float shadow = NEEDS(scene, BENT) ? bump_shadow(s, wi) : 1.0f;
    const vec3 f = scale(LOAD_LANE_vec3(values.f_cos, q), in_medium ? 1.0f : shadow / cosine);
    const vec3 light = mul(f, LOAD_LANE_vec3(pairs->power, q));
    const int j = pairs->lane[q];
    STORE_LANE_vec3(sums, j, add(LOAD_LANE_vec3(sums, j), select3(lit, light, make_vec3(0.0f, 0.0f, 0.0f))));
  }
  pairs->count = 0;
}

FN void add_pair(const PRIVATE Scene* scene, ulong families, const PRIVATE Surfaces* surfaces,
                 const PRIVATE Closures* closures, int j, vec3 wi, vec3 power, PRIVATE PhotonPairs* pairs,
                 PRIVATE float* sums) {
  const int q = pairs->count++;
  if (pairs->lane[q] != j) {
    store_surface(&pairs->surfaces, q, load_surface(surfaces, j));
    store_closure(&pairs->closures, q, load_closure(closures, j));
    pairs->lane[q] = j;
  }
  STORE_LANE_vec3(pairs->wi, q, wi);
  STORE_LANE_vec3(pairs->power, q, power);
  if (pairs->count == LANES) finish_pairs(scene, families, pairs, sums);
}

/// The photons of one map that LANES paths look up.
typedef struct {
  int map;                ///< PHOTON_MAP_*
  int lookup_size;        ///< about so many of the nearest; 0: all within the radius
  int wanted[LANES];      ///< 1: the lane has an estimate
  int most_edges[LANES];  ///< of photons
} PhotonRequest;

/// The most edges that photons may have where path i arrives with its next edge; 0: it takes none there.
FN int most_photon_edges(const PRIVATE SceneHeader* h, const PRIVATE PathState* paths, int i) {
  const int left = h->integrator.max_depth - (get_depth(paths, i) + 1);
  return left > 0 ? left : 0;
}

/// Adds to `sums`, a lane vec3, the radiance that photons scatter towards wo; in media over the scattering
/// coefficient, which is part of the path's weight.
STAGE void gather_photons(const PRIVATE Scene* scene, const PRIVATE PhotonRequest* request,
                          const PRIVATE Surfaces* surfaces, const PRIVATE Closures* closures, ulong families,
                          PRIVATE float* sums) {
  const PhotonTable table = photon_table(scene->photons, request->map);
  float found[3 * LANES], weights[LANES];
  PhotonPairs pairs;
  start_pairs(&pairs);
  for (int j = 0; j < LANES; j++) {
    STORE_LANE_vec3(found, j, make_vec3(0.0f, 0.0f, 0.0f));
    weights[j] = 0.0f;
    if (request->wanted[j] == 0) continue;
    const Surface s = load_surface(surfaces, j);
    const bool in_medium = s.primitive == IN_MEDIUM;
    PhotonSearch search = search_photons(&table, s.p, s.geometric, in_medium, request->most_edges[j]);
    if (request->lookup_size > 0 && request->lookup_size < table.map.count)
      search.radius2 = squared_lookup_radius(&table, search, request->lookup_size);
    weights[j] = table.map.share * inverse_extent(search.in_medium, search.radius2);
    const bool diffuse = (closures->family[j] == FAMILY_DIFFUSE) & (s.bumps == 0.0f);
    vec3 light = make_vec3(0.0f, 0.0f, 0.0f);
    for (int i = next_photon(&table, &search); i >= 0; i = next_photon(&table, &search)) {
      if (diffuse)
        light = add(light, photon_irradiance(&table, &search, s.shading, i));
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

/// The same for diffuse surfaces by the irradiance at the nearest photon that has one. Lanes of which none is
/// within the radius stay wanted.
STAGE void gather_irradiance(const PRIVATE Scene* scene, PRIVATE PhotonRequest* request,
                             const PRIVATE Surfaces* surfaces, const PRIVATE Closures* closures,
                             PRIVATE float* sums) {
  const PhotonTable table = photon_table(scene->photons, request->map);
  for (int j = 0; j < LANES; j++) {
    if (request->wanted[j] == 0) continue;
    const Surface s = load_surface(surfaces, j);
    const int nearest = nearest_photon(&table, search_photons(&table, s.p, s.geometric, false, 0));
    if (nearest < 0) continue;
    request->wanted[j] = 0;
    const vec3 reflectance = scale(LOAD_LANE_vec3(closures->diffuse, j), INV_PI_F);
    const vec3 irradiance = photon_vector(&table, table.powers, nearest);
    STORE_LANE_vec3(sums, j, add(LOAD_LANE_vec3(sums, j), mul(reflectance, irradiance)));
  }
}

PENUMBRA_NAMESPACE_END
#endif
