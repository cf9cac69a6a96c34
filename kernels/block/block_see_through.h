// Rays that pass through surfaces. All rays pass surfaces whose chosen leaf is empty (opacity masks, `null`);
// camera rays also pass hidden emitters, as in Mitsuba from 3.7 on. The step that follows finds the surface
// where a ray ends, as seen from where the ray started. Passed surfaces count neither for the depth nor for
// Russian roulette, and pdfs are those without them. The emission of a passed surface is added.
// block_see_lights.h follows shadow rays.
//
// A ray is under way (still travels) while its `ray_tmax` is above 0. A ray that has arrived waits until all
// have arrived. Coincident surfaces may be passed in a single step. A ray that has passed MOST_PASSED
// surfaces is absorbed.
#ifndef PENUMBRA_BLOCK_SEE_THROUGH_H
#define PENUMBRA_BLOCK_SEE_THROUGH_H
#include "kernels/block/block_emission.h"
#include "kernels/block/block_instances.h"
#include "kernels/block/block_media.h"
#include "kernels/block/block_surface.h"
#include "kernels/block/block_trace.h"
#include "kernels/bsdf/material_tree.h"
#include "kernels/integrator/direct.h"
#include "kernels/integrator/path_stages.h"
#include "kernels/photon/photon_beams.h"

PENUMBRA_NAMESPACE_BEGIN

/// Saves what restarting overwrites. Rays that hit nothing have arrived.
STAGE void keep_starts(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const float tmax = get_ray_tmax(paths, j);
        const int hit = get_hit(paths, j);
        set_kept_origin(paths, j, get_ray_origin(paths, j));
        set_kept_tmax(paths, j, tmax);
        set_kept_hit(paths, j, hit);
        set_ray_tmax(paths, j, hit >= 0 ? tmax : -1.0f);
      }
  }
}

/// Restarts rays that pass these surfaces behind them. The others that were under way have arrived. Returns
/// whether any ray goes on.
STAGE bool restart_behind(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces,
                          const PRIVATE int* RESTRICT passes) {
  int any = 0;
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const vec3 origin = get_ray_origin(&fields, i + j), toward = get_ray_direction(&fields, i + j);
      const int skip = get_ray_skip(&fields, i + j), hit = get_hit(&fields, i + j);
      const int kept = get_kept_hit(&fields, i + j);
      const float tmax = get_ray_tmax(&fields, i + j);
      const bool under_way = tmax > 0.0f, through = passes[j] != 0;
      const float left = tmax < NO_LIMIT ? tmax - s.distance : tmax;
      const bool goes_on = through & (left > 0.0f);
      set_ray_origin(&fields, i + j,
                     select3(through, leave_surface(s.p, s.geometric, s.error, toward), origin));
      set_ray_skip(&fields, i + j, through ? s.primitive : skip);
      set_ray_tmax(&fields, i + j, goes_on ? left : -1.0f);
      set_kept_hit(&fields, i + j, under_way ? (through ? -1 : hit) : kept);
      any |= goes_on ? 1 : 0;
    }
  return any != 0;
}

/// All rays that were under way have arrived.
STAGE void arrive(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) {
      const int hit = get_hit(paths, j), kept = get_kept_hit(paths, j);
      set_kept_hit(paths, j, get_ray_tmax(paths, j) > 0.0f ? hit : kept);
      set_ray_tmax(paths, j, -1.0f);
    }
}

/// Sets which rays under way pass their hits: those that hit emitters, if `hides` (emitters are hidden).
STAGE void pass_hidden(const PRIVATE PathState* paths, int i, bool hides,
                       const PRIVATE Surfaces* RESTRICT surfaces, PRIVATE int* RESTRICT passes) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool hit = (get_ray_tmax(paths, i + j) > 0.0f) & (surfaces->primitive[j] >= 0);
      passes[j] = (hides & hit & (surfaces->light[j] >= 0)) ? 1 : 0;
    }
}

STAGE void clear_leaves(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) set_material(paths, j, -1);
  }
}

/// Whether any ray under way hit a surface whose leaf is chosen at random or that lets rays pass.
FN bool any_choice(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  int any = 0;
  for (int j = i; j < i + LANES; j++) {
    const int hit = get_hit(paths, j);
    const SideMaterials sides = side_materials(scene, hit);
    GLOBAL const Material* front = scene->materials + sides.front;
    GLOBAL const Material* back = scene->materials + sides.back;
    const int special = front->branches | front->passes | back->branches | back->passes;
    any |= ((get_ray_tmax(paths, j) > 0.0f) & (hit >= 0) & (special != 0)) ? 1 : 0;
  }
  return any != 0;
}

/// Stores the leaves of rays that arrive. The other rays under way pass.
STAGE void note_leaves(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                       const PRIVATE Surfaces* RESTRICT surfaces, const PRIVATE int* RESTRICT leaves,
                       PRIVATE int* RESTRICT passes) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int before = get_material(paths, i + j), leaf = leaves[j], hidden = passes[j];
      const bool hit = (get_ray_tmax(paths, i + j) > 0.0f) & (surfaces->primitive[j] >= 0);
      const bool through = hit & ((leaf < 0) | (hidden != 0));
      passes[j] = through ? 1 : 0;
      // If the leaf is the side's own material, it is not stored, so that the result does not depend on the
      // other lanes. A pane is stored: a ray may meet it behind another side of the same primitive.
      bool is_chosen = leaf != surfaces->material[j];
      if (HAS(PANES)) is_chosen = is_chosen | (pane_of(scene, leaf) > 0.0f);
      set_material(paths, i + j, (hit & !through & is_chosen) ? leaf : before);
    }
}

/// Adds the emission of passed surfaces in the `step`-th step.
FN void add_passed_light(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int step,
                         const PRIVATE Surfaces* surfaces, const PRIVATE int* passes) {
  const int kind = scene->header.integrator.kind;
  if ((HAS(PATH) || HAS(WHITTED)) && (kind == INTEGRATOR_PATH || kind == INTEGRATOR_WHITTED))
    add_passed_by_path(scene, paths, i, step, surfaces, passes);
  if (HAS(DIRECT) && kind == INTEGRATOR_DIRECT) add_passed_directly(scene, paths, i, step, surfaces, passes);
}

FN bool any_passed_light(const PRIVATE Surfaces* surfaces, const PRIVATE int* passes) {
  int any = 0;
  for (int j = 0; j < LANES; j++) any |= ((passes[j] != 0) & (surfaces->light[j] >= 0)) ? 1 : 0;
  return any != 0;
}

/// The random point for the k-th surfaces that the rays of a step meet. Directions that the direct integrator
/// samples have depth 0, like the camera ray; an offset gives them numbers of their own.
FN PairPoint ray_surface_point(const PRIVATE Scene* scene, int step, int k) {
  PairPoint point = met_point(k);
  if (scene->header.integrator.kind != INTEGRATOR_DIRECT || step == 0) return point;
  point.pair += MOST_PASSED;
  return nth_point(point, scene->header.integrator.bsdf_samples, step - 1);
}

/// Multiplies the throughputs of paths that pass (leaf -1) by the colours of panes.
STAGE void tint_paths(const PRIVATE PathState* paths, int i, const PRIVATE int* RESTRICT leaves,
                      const PRIVATE PaneTints* RESTRICT tints) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 before = get_throughput(&fields, i + j);
      const bool passes = (get_ray_tmax(&fields, i + j) > 0.0f) & (leaves[j] < 0);
      set_throughput(&fields, i + j, select3(passes, mul(before, load_pane_tint(tints, j).colour), before));
    }
}

/// Chooses the leaves of the k-th surfaces that the rays meet, and adds the emission of those that they pass.
FN void pass_by_chance(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int step, int k,
                       const PRIVATE Surfaces* surfaces, PRIVATE int* passes) {
  const PRIVATE SceneHeader* h = &scene->header;
  float numbers[LANES], others[LANES], shares[LANES];
  int leaves[LANES];
  for (int j = 0; j < LANES; j++) {
    leaves[j] = surfaces->material[j];
    numbers[j] = 0.0f;
  }
  if (any_chance(scene, leaves))
    sample_pair(h->sampler.kind, sequence_length(h), ray_surface_point(scene, step, k), paths, i, numbers,
                others);
  walk_to_leaves(scene, surfaces, numbers, leaves);
  leaf_shares(scene, surfaces, leaves, shares);
  PaneTints tints;
  const bool panes = NEEDS(scene, PANES) && any_pane(scene, leaves);
  if (HAS(PANES) && panes) find_tints(scene, surfaces, leaves, &tints);
  pass_leaves(numbers, shares, leaves);
  note_leaves(scene, paths, i, surfaces, leaves, passes);
  if (!TRACES_PHOTONS(scene) && any_passed_light(surfaces, passes)) {
    Surfaces seen = *surfaces;
    see_from_starts(paths, i, &seen);
    add_passed_light(scene, paths, i, step, &seen, passes);
  }
  if (HAS(PANES) && panes) tint_paths(paths, i, leaves, &tints);
}

/// Starts the flights of LANES paths.
FN void start_flying(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  const PRIVATE SceneHeader* h = &scene->header;
  float roulette[LANES], flights[LANES];
  sample_pair(h->sampler.kind, sequence_length(h), step_point(PAIR_END), paths, i, roulette, flights);
  start_flights(paths, i, flights);
  if (NEEDS_GLOWS(scene)) note_left_pdfs(paths, i);
}

/// Of LANES rays from lane i on, those that pass the k-th surface they meet restart behind it; the others
/// arrive. Returns whether any ray goes on.
FN bool pass_surfaces(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int step, int k,
                      bool hides) {
  Surfaces surfaces;
  int passes[LANES];
  const bool chooses = NEEDS(scene, NESTED) && any_choice(scene, paths, i);
  float lengths[LANES];
  const bool flies = NEEDS_MEDIA(scene) && any_in_media(scene, paths, i);
  if (!hides && !chooses && !flies) {
    if (NEEDS(scene, INSTANCES)) arrive_at_instances(paths, i);
    arrive(paths, i);
    return false;
  }
  find_hit_surfaces(scene, paths, i, &surfaces);
  if (HAS(MEDIA) && flies) flight_lengths(paths, i, &surfaces, lengths);
  if (HAS(MEDIA) && flies) {
    float reaches[LANES];
    int decided[LANES];
    if (NEEDS_EMITTING_MEDIA(scene) && !TRACES_PHOTONS(scene)) add_media_emission(scene, paths, i, lengths);
    if (NEEDS_PHOTONS(scene) && !TRACES_PHOTONS(scene)) add_beams(scene, paths, i, lengths);
    for (int j = 0; j < LANES; j++) {
      reaches[j] = -1.0f;
      decided[j] = 0;
    }
    if (has_grids(scene)) fly_through_grids(scene, paths, i, lengths, reaches, decided);
    sample_equiangular(scene, paths, i, lengths, reaches, decided);
    fly(scene, paths, i, surfaces.primitive, lengths, decided, reaches);
    scatter_in_media(paths, i, &surfaces, lengths, reaches);
    if (has_grids(scene)) apply_grid_albedo(scene, paths, i, reaches);
    if (NEEDS_INTERIORS(scene)) apply_inner_albedo(scene, paths, i, reaches);
  }
  pass_hidden(paths, i, hides, &surfaces, passes);
  if (HAS(NESTED) && chooses) pass_by_chance(scene, paths, i, step, k, &surfaces, passes);
  if (HAS(MEDIA) && flies) follow_boundaries(scene, paths, i, lengths, passes, false, &surfaces);
  if (NEEDS(scene, INSTANCES)) restart_behind_instances(paths, i, &surfaces, passes);
  return restart_behind(paths, i, &surfaces, passes);
}

/// Restores what was saved. A ray that passed too many surfaces sees the next hidden emitter without its
/// light, or black. If no leaf was chosen, nothing was passed by chance, and the surface is found from the
/// ray's original origin.
FN void end_way(const PRIVATE PathState* paths, int j, bool restores_origin) {
  const vec3 start = get_kept_origin(paths, j), origin = get_ray_origin(paths, j);
  const int skip = get_ray_skip(paths, j), hit = get_hit(paths, j), kept = get_kept_hit(paths, j);
  set_hit(paths, j, get_ray_tmax(paths, j) > 0.0f ? hit : kept);
  set_ray_origin(paths, j, select3(restores_origin, start, origin));
  set_ray_skip(paths, j, restores_origin ? -1 : skip);
  set_ray_tmax(paths, j, get_kept_tmax(paths, j));
}
STAGE void end_ways(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) end_way(paths, j, true);
  }
}
STAGE void end_ways_by_choice(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) end_way(paths, j, get_material(paths, j) < 0);
  }
}

/// Rays that passed too many surfaces end on the black material.
STAGE void blacken_unfinished(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const int leaf = get_material(paths, j);
        set_material(paths, j, get_ray_tmax(paths, j) > 0.0f ? 0 : leaf);
      }
  }
}

/// Follows the rays of the `step`-th step from their first hits to where they end.
CALLED_FN void see_through(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count, int step) {
  const bool nested = NEEDS(scene, NESTED);
  const bool hides = step == 0 && scene->header.integrator.hide_emitters == HIDE_LOOK_THROUGH;
  if (!nested && !hides) return;
  keep_starts(paths, count);
  if (NEEDS(scene, INSTANCES)) keep_start_instances(paths, count);
  if (HAS(NESTED) && nested) clear_leaves(paths, count);
  const int most = NEEDS_MEDIA(scene) ? MOST_CROSSED : MOST_PASSED;
  if (NEEDS_MEDIA(scene))
    for (int i = 0; i < count; i += LANES) start_flying(scene, paths, i);
  bool any = true;
  for (int k = 0; any && k < most; k++) {
    any = false;
    for (int i = 0; i < count; i += LANES)
      if (any_ray(paths, i)) any = pass_surfaces(scene, paths, i, step, k, hides) | any;
    if (any) intersect_block(scene, paths, count, false);
    if (any) pad_hits(scene, paths, count);
  }
  if (NEEDS(scene, INSTANCES)) end_ways_at_instances(paths, count);
  if (HAS(NESTED) && nested) blacken_unfinished(paths, count);
  if (HAS(NESTED) && nested) end_ways_by_choice(paths, count);
  if (!nested) end_ways(paths, count);
}

PENUMBRA_NAMESPACE_END
#endif
