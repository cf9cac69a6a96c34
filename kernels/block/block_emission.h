// The light that media emit along the rays of paths.
#ifndef PENUMBRA_BLOCK_EMISSION_H
#define PENUMBRA_BLOCK_EMISSION_H
#include "kernels/block/block_media.h"
#include "kernels/integrator/path_stages.h"
#include "kernels/medium/emission.h"

PENUMBRA_NAMESPACE_BEGIN

/// Whether path i is under way in a medium whose emission it takes. The camera sees it even where emitters
/// are hidden.
FN bool takes_emission(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  GLOBAL const Medium* medium = scene->media + innermost(get_media(paths, i));
  const bool kept = !HAS(PARTS) || is_kept_part(&scene->header, get_depth(paths, i), TECHNIQUE_BSDF);
  return (get_ray_tmax(paths, i) > 0.0f) & emits_light(medium) & kept;
}

/// Adds the emission of media in which it is the same everywhere, from the rays' last boundaries over
/// `lengths`, where nothing is weighed against it.
STAGE void add_even_emission(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                             const PRIVATE EmissionBalance* RESTRICT balances,
                             const PRIVATE float* RESTRICT lengths) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      GLOBAL const Medium* medium = scene->media + innermost(get_media(&fields, i + j));
      const vec3 emission = load3(&medium->emission), extinction = load3(&medium->extinction);
      const vec3 collected = even_emission(extinction, emission, lengths[j]);
      const vec3 before = get_radiance(&fields, i + j);
      const vec3 after = add(before, mul(get_throughput(&fields, i + j), collected));
      const bool takes =
          takes_emission(scene, &fields, i + j) & emits_evenly(medium) & (balances[j].light == 0.0f);
      set_radiance(&fields, i + j, select3(takes, after, before));
    }
}

/// Sets what weighs against samples of lights, of LANES rays, but where their media are no lights, and where
/// no light was sampled in their directions, as by the camera and at smooth glass.
FN void balance_emission(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                         PRIVATE EmissionBalance* balances) {
  FoundLights found;
  int any = 0;
  for (int j = 0; j < LANES; j++) {
    const float pdf = get_left_pdf(paths, i + j);
    const int light = scene->media[innermost(get_media(paths, i + j))].light;
    const bool sampled = (light >= 0) & (get_depth(paths, i + j) > 0) & (pdf > 0.0f) & (pdf != DELTA_PDF);
    found.light[j] = sampled ? light : -1;
    found.pmf[j] = scene->lights[light >= 0 ? light : 0].pmf;
    any |= sampled ? 1 : 0;
  }
  if (any == 0) return;
  if (NEEDS_LIGHT_TREE(scene)) find_previous_pmfs(scene, paths, i, &found);
  for (int j = 0; j < LANES; j++) {
    if (found.light[j] < 0) continue;
    balances[j].way = get_way(paths, i + j);
    balances[j].heuristic = scene->header.integrator.heuristic;
    balances[j].direction = get_left_pdf(paths, i + j);
    balances[j].light = found.pmf[j] / scene->lights[found.light[j]].area;
  }
}

/// The same for all media. Throughputs are those at the last boundaries.
FN void add_media_emission(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                           const PRIVATE float* lengths) {
  EmissionBalance balances[LANES];
  for (int j = 0; j < LANES; j++) balances[j] = no_balance();
  if (NEEDS_GLOWS(scene)) balance_emission(scene, paths, i, balances);
  add_even_emission(scene, paths, i, balances, lengths);
  if (!has_grids(scene)) return;
  for (int j = 0; j < LANES; j++) {  // no lane loop: the number of points differs
    GLOBAL const Medium* medium = scene->media + innermost(get_media(paths, i + j));
    const bool even = emits_evenly(medium);
    if ((even && balances[j].light == 0.0f) || !takes_emission(scene, paths, i + j)) continue;
    const float way = get_way(paths, i + j);
    const vec3 direction = get_ray_direction(paths, i + j),
               start = add_scaled(get_kept_origin(paths, i + j), way, direction);
    const uint random = ray_state(paths, i + j, way, 0x6a09e667u);
    const vec3 collected =
        even ? weighed_even_emission(medium, lengths[j], balances[j], random)
             : track_emission(scene, medium, start, direction, lengths[j], balances[j], random);
    set_radiance(paths, i + j, add(get_radiance(paths, i + j), mul(get_throughput(paths, i + j), collected)));
  }
}

PENUMBRA_NAMESPACE_END
#endif
