// What photon maps change for the paths of the camera. A path ends at the first surface with a diffuse part,
// or point in a medium, that scatters it: photons bring the indirect light there. Direct light is still
// sampled there, by the light and by one last ray. Up to there, at mirrors, glass and glossy surfaces without
// a diffuse part, it is a path of the path tracer.
//
// With final gathering, a path takes only caustics from photons there, and goes on to the next such surface
// (Christensen 1999). On the way it leaves out light that the caustic map has. If the next surface is nearer
// than the radius, where densities would show as blotches, it goes on once more. With GATHER_CAUSTICS it
// always goes on: photons bring nothing but the caustics.
#ifndef PENUMBRA_PHOTON_CHAINS_H
#define PENUMBRA_PHOTON_CHAINS_H
#include "kernels/integrator/path_stages.h"
#include "kernels/photon/photon_gather.h"

PENUMBRA_NAMESPACE_BEGIN

/// Drops light samples at surfaces without a diffuse part that the path reached from a diffuse one: photons
/// bring their light to the diffuse one. Likewise behind the surface that took photons.
STAGE void drop_photon_samples(const PRIVATE PathState* paths, int i,
                               const PRIVATE Closures* RESTRICT closures,
                               PRIVATE LightSamples* RESTRICT lights) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int chain = get_chain(paths, i + j);
      const bool dropped =
          ((chain != CHAIN_SPECULAR) & !has_diffuse_part(load_closure(closures, j))) | (chain >= CHAIN_LAST);
      lights->tmax[j] = dropped ? -1.0f : lights->tmax[j];
    }
}

/// Whether the path's indirect light at this surface comes from photons.
FN bool ends_at_photons(const PRIVATE SceneHeader* h, int chain, float distance, Closure c) {
  const bool near = (chain == CHAIN_DIFFUSE) & (distance < h->integrator.surface_radius);
  const int gathering = h->integrator.gathering;
  const bool goes_on =
      (gathering == GATHER_SECOND) & (c.family != FAMILY_PHASE) & ((chain == CHAIN_SPECULAR) | near);
  return has_diffuse_part(c) & (gathering != GATHER_CAUSTICS) & !goes_on;
}

#define NO_DEPTH_LIMIT 0x7fffffff

/// Whether the path takes photons of that map at this surface. Behind a diffuse bounce, irradiances at
/// photons are enough (Christensen 1999), where they are known: all edges together, for the diffuse family.
FN bool takes_photons(const PRIVATE SceneHeader* h, int map, int chain, float distance, Closure c) {
  const bool ends = ends_at_photons(h, chain, distance, c);
  const bool by_irradiance = ends & (h->integrator.gathering == GATHER_SECOND) &
                             (c.family == FAMILY_DIFFUSE) & (h->integrator.max_depth == NO_DEPTH_LIMIT);
  const bool caustics = (map == PHOTON_MAP_CAUSTIC) | (h->integrator.gathering == GATHER_CAUSTICS);
  if (map == PHOTON_MAP_IRRADIANCE) return by_irradiance;
  return !by_irradiance & (caustics ? has_diffuse_part(c) : ends);
}

/// The photons of one map that the paths take at these surfaces. Returns whether any path takes some.
FN bool request_photons(const PRIVATE Scene* scene, int map, const PRIVATE PathState* paths, int i,
                        const PRIVATE Surfaces* surfaces, const PRIVATE Closures* closures,
                        PRIVATE PhotonRequest* request) {
  const PRIVATE SceneHeader* h = &scene->header;
  int any = 0;
  request->map = map;
  request->lookup_size = h->integrator.photons == PHOTONS_FIXED ? h->integrator.lookup_size : 0;
  for (int j = 0; j < LANES; j++) {
    const Closure c = load_closure(closures, j);
    const int edges = most_photon_edges(h, paths, i + j);
    const bool in_medium = surfaces->primitive[j] == IN_MEDIUM;
    const bool wanted =
        (surfaces->primitive[j] != NOTHING_HIT) & (edges > 0) & (get_chain(paths, i + j) < CHAIN_LAST) &
        (map == PHOTON_MAP_VOLUME ? in_medium && !has_beam(scene, paths, i + j) : !in_medium) &
        takes_photons(h, map, get_chain(paths, i + j), surfaces->distance[j], c);
    request->wanted[j] = wanted ? 1 : 0;
    request->most_edges[j] = wanted ? edges : 0;
    any |= wanted ? 1 : 0;
  }
  return any != 0;
}

STAGE void add_photon_light(const PRIVATE PathState* paths, int i, const PRIVATE float* RESTRICT light) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 found = mul(get_throughput(paths, i + j), LOAD_LANE_vec3(light, j));
      set_radiance(paths, i + j, add(get_radiance(paths, i + j), found));
    }
}

/// Adds the light that photons bring to the step's surfaces.
CALLED_FN void add_photons(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                           const PRIVATE StepLanes* step) {
  const PRIVATE SceneHeader* h = &scene->header;
  float light[3 * LANES];
  for (int k = 0; k < 3 * LANES; k++) light[k] = 0.0f;
  for (int map = 0; map < PHOTON_MAPS; map++) {
    PhotonRequest request;
    if (map == PHOTON_MAP_CAUSTIC && h->integrator.photons != PHOTONS_FIXED) continue;
    if (map == PHOTON_MAP_VOLUME && !NEEDS_MEDIA(scene)) continue;
    if (map == PHOTON_MAP_IRRADIANCE && h->integrator.gathering != GATHER_SECOND) continue;
    if (is_empty_map(scene->photons, map)) continue;
    if (!request_photons(scene, map, paths, i, &step->surfaces, &step->closures, &request)) continue;
    if (map == PHOTON_MAP_IRRADIANCE) {
      gather_irradiance(scene, &request, &step->surfaces, &step->closures, light);
      for (request.map = PHOTON_MAP_SURFACE; request.map <= PHOTON_MAP_CAUSTIC; request.map++)
        gather_photons(scene, &request, &step->surfaces, &step->closures, step->families, light);
    } else {
      gather_photons(scene, &request, &step->surfaces, &step->closures, step->families, light);
    }
  }
  add_photon_light(paths, i, light);
}

/// After the next rays are requested: a path whose indirect light came from photons has one last ray, which
/// only finds emission, unless a delta direction goes on. Where media emit, it goes on for their emission
/// alone.
STAGE void follow_chains(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                         const PRIVATE Surfaces* RESTRICT surfaces,
                         const PRIVATE Closures* RESTRICT closures) {
  const PRIVATE SceneHeader* h = &scene->header;
  const int last = h->integrator.max_depth - 1;
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Closure c = load_closure(closures, j);
      const int chain = get_chain(&fields, i + j), depth = get_depth(&fields, i + j);
      const bool delta = get_direction_pdf(&fields, i + j) == DELTA_PDF;
      const bool diffuse = has_diffuse_part(c) & !delta;
      const bool ends = diffuse & ends_at_photons(h, chain, surfaces->distance[j], c);
      const bool goes_on = NEEDS_EMITTING_MEDIA(scene);
      set_depth(&fields, i + j, (ends & !goes_on) ? last : depth);
      const int next = next_chain(chain, diffuse);
      set_chain(&fields, i + j, (ends & goes_on & (chain < CHAIN_LAST)) ? CHAIN_LAST : next);
    }
}

PENUMBRA_NAMESPACE_END
#endif
