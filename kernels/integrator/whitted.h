// Recursive ray tracing after Whitted 1980, without recursion. At mirrors and glass both branches are
// followed, each with its exact weight. At other surfaces light is sampled as by the path integrator, and
// `bsdf_samples` directions of the hemisphere sample the rest. A path branches at its first `branch_depth`
// surfaces; beyond them it chooses one branch by its probability, as the path integrator does. The expected
// radiance is that of the path integrator. Stages that integrators share are in
// path_stages.h and step.h.
#ifndef PENUMBRA_INTEGRATOR_WHITTED_H
#define PENUMBRA_INTEGRATOR_WHITTED_H
#include "kernels/integrator/branches.h"
#include "kernels/integrator/directions.h"
#include "kernels/integrator/dispersion.h"
#include "kernels/integrator/path_stages.h"

PENUMBRA_NAMESPACE_BEGIN

// The stages of a step, each for LANES paths from lane i on.

// A pdf for light samples where no direction is sampled: it gives competing strategies no MIS weight.
#define NO_RIVAL 1e-37f

/// The number of directions that a path samples at a surface that scatters in all directions. (It is 1 at the
/// hits of camera rays that look through emitters, and of rays that pass surfaces at random: these rays would
/// not return to the same surface.)
FN int directions_at(const PRIVATE SceneHeader* h, int depth) {
  const int samples = h->integrator.bsdf_samples;
  const bool leads_back =
      ((depth > 0) | (h->integrator.hide_emitters != HIDE_LOOK_THROUGH)) & (h->integrator.leads_back != 0);
  return ((depth < h->integrator.branch_depth) & leads_back) ? samples : min_i(samples, 1);
}

/// Whether any of LANES paths from lane i on may end by Russian roulette.
FN bool any_roulette(const PRIVATE SceneHeader* h, const PRIVATE PathState* paths, int i) {
  int deepest = 0;
  for (int j = i; j < i + LANES; j++) deepest = get_depth(paths, j) > deepest ? get_depth(paths, j) : deepest;
  return deepest + 1 >= h->integrator.rr_depth;
}

/// Paths that return to a surface have already added its emission.
STAGE void drop_found_again(const PRIVATE PathState* paths, int i, PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) found->light[j] = get_revisit(paths, i + j) != 0 ? -1 : found->light[j];
}

/// While the surfaces' closed forms are added, paths that return, or end there, have throughput 0 ...
STAGE void hide_throughputs(int max_depth, const PRIVATE PathState* paths, int i,
                            PRIVATE float* RESTRICT hidden) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 throughput = get_throughput(paths, i + j);
      const bool adds = (get_revisit(paths, i + j) == 0) & (get_depth(paths, i + j) + 1 < max_depth);
      STORE_LANE_vec3(hidden, j, throughput);
      set_throughput(paths, i + j, select3(adds, throughput, make_vec3(0.0f, 0.0f, 0.0f)));
    }
}
/// ... and afterwards their own again.
STAGE void restore_throughputs(const PRIVATE PathState* paths, int i, const PRIVATE float* RESTRICT hidden) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) set_throughput(paths, i + j, LOAD_LANE_vec3(hidden, j));
}

/// Requests the lights of a step.
FN void request_whitted_lights(const PRIVATE Scene* scene, bool scatters, bool finds, PRIVATE StepLanes* step,
                               const PRIVATE PathState* paths, int i) {
  const bool balances = scene->header.integrator.bsdf_samples > 0;
  const LightRequest request = light_request(scene, true, scatters, scatters, balances);
  if (HAS(POLYGONS) && request.closed) {
    float throughputs[3 * LANES];
    hide_throughputs(scene->header.integrator.max_depth, paths, i, throughputs);
    request_lights(scene, request, finds, step, paths, i);
    restore_throughputs(paths, i, throughputs);
    return;
  }
  request_lights(scene, request, finds, step, paths, i);
}

/// Replaces the values' pdfs by the pdf with which all direction samples together sample the light's
/// direction. It is 0 for paths that return to a surface, so that they request no light again.
STAGE void balance_values(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          PRIVATE StepLanes* RESTRICT step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const ulong by_themselves = families_with_own_directions(h);
  const int kind = h->integrator.bsdf_sampling;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float own = step->values.pdf[j];
      const float n = (float)directions_at(h, get_depth(paths, i + j));
      const float pdf = direction_pdf(kind, LOAD_LANE_vec3(step->surfaces.shading, j),
                                      LOAD_LANE_vec3(step->lights.wi, j), own);
      const float all = n * (is_among(load_closure(&step->closures, j), by_themselves) ? own : pdf);
      const bool asks = (own > 0.0f) & (get_revisit(paths, i + j) == 0);
      step->values.pdf[j] = asks ? max_f(all, NO_RIVAL) : 0.0f;
    }
}

/// Whether each path branches here: at a surface with two delta lobes (`lobes`), or by `more` direction
/// samples than one.
typedef struct {
  int lobes[LANES];
  int more[LANES];
} Branching;

STAGE void find_branching(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          const PRIVATE StepLanes* RESTRICT step, PRIVATE Branching* RESTRICT branching) {
  const PRIVATE SceneHeader* h = &scene->header;
  const int max_depth = h->integrator.max_depth, branch_depth = h->integrator.branch_depth;
  const ulong deltas = families_with(DELTA), with_two = branching_families();
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Closure c = load_closure(&step->closures, j);
      const int depth = get_depth(paths, i + j);
      const bool may = (step->surfaces.primitive[j] >= 0) & (depth < branch_depth) & (depth + 1 < max_depth) &
                       (get_revisit(paths, i + j) == 0) & (c.family != FAMILY_BLACK);
      branching->lobes[j] = (may & is_among(c, with_two)) ? 1 : 0;
      const int directions = directions_at(h, depth);
      branching->more[j] = (may & !is_among(c, deltas) & (directions > 1)) ? directions - 1 : 0;
    }
}

FN bool any_of(const PRIVATE int* flags) {
  int any = 0;
  for (int j = 0; j < LANES; j++) any |= flags[j];
  return any != 0;
}

/// Paths that branch take the first lobe.
STAGE void choose_first_lobes(const PRIVATE Branching* RESTRICT branching, PRIVATE float* RESTRICT choice) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) choice[j] = branching->lobes[j] != 0 ? 0.0f : choice[j];
}

/// Divides the weight of a sample by the number of samples at its vertex, and multiplies its pdf by that
/// number. Where both lobes are followed, the weight is multiplied by the probability of choosing its lobe
/// instead: the sample's weight contains the inverse of that probability.
STAGE void weigh_branches(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          const PRIVATE Branching* RESTRICT branching,
                          const PRIVATE float* RESTRICT probabilities, PRIVATE StepLanes* RESTRICT step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const ulong deltas = families_with(DELTA);
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool delta = is_among(load_closure(&step->closures, j), deltas);
      const int n = delta ? 1 : directions_at(h, get_depth(paths, i + j));
      const float several = (float)(n > 0 ? n : 1);
      BsdfSample s = load_bsdf_sample(&step->samples, j);
      const bool counts = (n > 0) | (s.pdf == DELTA_PDF);
      s.weight = scale(s.weight, branching->lobes[j] != 0 ? probabilities[j] : 1.0f / several);
      s.pdf = counts ? several * s.pdf : 0.0f;
      store_bsdf_sample(&step->samples, j, s);
    }
}

/// The branches of second lobes; without a second lobe the throughput is 0.
STAGE void second_branches(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                           const PRIVATE StepLanes* RESTRICT step,
                           const PRIVATE Branching* RESTRICT branching,
                           const PRIVATE float* RESTRICT probabilities,
                           const PRIVATE BsdfSamples* RESTRICT samples, PRIVATE Branches* RESTRICT branches) {
  const int rr_depth = scene->header.integrator.rr_depth;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      const BsdfSample next = load_bsdf_sample(samples, j);
      Branch b = arriving_branch(scene, paths, i + j, 0);
      b.depth++;
      b.eta *= next.eta;
      const vec3 throughput = mul(b.throughput, scale(next.weight, 1.0f - probabilities[j]));
      const float strongest = max_component(throughput);
      const float survival = path_survival(rr_depth, b.depth, strongest, b.eta, 0.0f);
      // The first branch uses this number itself.
      const float number = ONE_MINUS_EPSILON - lane_number(step, DIM_ROULETTE, j);
      const bool alive = (branching->lobes[j] != 0) & (next.pdf > 0.0f) & (strongest > 0.0f) &
                         !is_cut_off(scene, s, load_closure(&step->closures, j), next.wi) &
                         (number < survival);
      b.origin = leave_surface(s.p, s.geometric, s.error, next.wi);
      b.direction = next.wi;
      b.throughput =
          select3(alive, scale(throughput, 1.0f / (alive ? survival : 1.0f)), make_vec3(0.0f, 0.0f, 0.0f));
      b.skip = s.primitive;
      b.instance = s.instance;
      b.pixel_hash = branch_sequence(b.pixel_hash, 0);
      store_branch(branches, j, b);
    }
}

/// Stacks second lobes for later.
STAGE void push_second_branches(const PRIVATE PathState* paths, int i, int count,
                                const PRIVATE Branches* RESTRICT branches) {
  for (int j = 0; j < min_i(LANES, count - i); j++) {
    const Branch b = load_branch(branches, j);
    if (max_component(b.throughput) > 0.0f) push_branch(paths, i + j, b);
  }
}

/// Stacks the rays that lead paths back for more direction samples.
STAGE void push_revisits(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int count,
                         const PRIVATE Branching* RESTRICT branching) {
  for (int j = 0; j < min_i(LANES, count - i); j++) {
    const int more = branching->more[j];
    if (more > 0) push_branch(paths, i + j, arriving_branch(scene, paths, i + j, more));
  }
}

/// Samples directions for LANES paths from lane i on. step->samples gets the one that each path takes; the
/// others are stacked.
FN void sample_branches(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int count,
                        PRIVATE StepLanes* step) {
  PRIVATE float* choice = step->u + DIM_LOBE_CHOICE * LANES;
  Branching branching;
  float probabilities[LANES];
  find_branching(scene, paths, i, step, &branching);
  const bool lobes = any_of(branching.lobes);
  if (lobes) choose_first_lobes(&branching, choice);
  sample_directions(scene, step);
  lobe_probabilities(lobes ? step->families : 0u, &step->closures, &step->surfaces, probabilities);
  weigh_branches(scene, paths, i, &branching, probabilities, step);
  if (any_of(branching.more)) push_revisits(scene, paths, i, count, &branching);
  if (!lobes) return;
  BsdfSamples others;
  Branches branches;
  for (int j = 0; j < LANES; j++) choice[j] = ONE_MINUS_EPSILON;
  sample_bsdfs(scene, step->families & branching_families(), &step->closures, &step->surfaces,
               step->u + DIM_BSDF_U * LANES, choice, &others);
  shade_bumps(scene, &step->surfaces, &others);
  second_branches(scene, paths, i, step, &branching, probabilities, &others, &branches);
  push_second_branches(paths, i, count, &branches);
}

/// Paths that returned to a surface have left it.
STAGE void end_revisits(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_revisit(paths, j, 0);
}

/// Processes the surfaces where the paths' last rays ended.
CALLED_FN void step_whitted(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count, int steps,
                            const PRIVATE SlotState* slots) {
  const PRIVATE SceneHeader* h = &scene->header;
  const bool balances = h->integrator.bsdf_samples > 0, revisits = h->integrator.bsdf_samples > 1;
  StepLanes step;
  start_step(&step);
  for (int i = 0; i < count; i += LANES) {
    if (steps == 0) start_branches(paths, i);
    const bool scatters = any_scatters(scene, paths, i);
    if (scatters) path_numbers(h, any_roulette(h, paths, i), paths, i, step.u);

    // The surfaces that the last rays hit, and their BSDFs.
    find_surfaces(scene, paths, i, &step.surfaces);
    resolve_step_closures(scene, &step);
    if (steps == 0) record_first_hits(scene, &step.surfaces, &step.closures, paths, i, slots);

    // Emission that the rays hit, weighted against the light samples that could have found it.
    if (NEEDS_LIGHT(scene, SUN)) add_suns_by_path(scene, paths, i, steps, &step.surfaces);
    const bool finds = any_finds_light(scene, &step.surfaces);
    if (finds) find_lights(scene, &step.surfaces, &step.found);
    request_whitted_lights(scene, scatters, finds, &step, paths, i);
    if (finds) find_emissions(scene, &step.found, balances & (steps > 0), &step.emissions);
    if (finds & revisits) drop_found_again(paths, i, &step.found);
    if (NEEDS(scene, POLYGONS) && finds) drop_controlled(paths, i, &step.emissions, &step.found);
    if (NEEDS(scene, POLYGONS)) note_controlled(scene, paths, i, &step.closures);
    if (finds) add_emissions(scene, paths, i, &step.found, &step.emissions);

    if (scatters) {
      if (NEEDS(scene, DISPERSION)) disperse(scene, true, paths, i, &step);

      // Next-event estimation: a point on a light, and the shadow ray to it.
      sample_step_lights(scene, &step);
      eval_bsdfs(scene, step.families, &step.closures, &step.surfaces, step.lights.wi, &step.values);
      if (HAS(LTC) && has_lobe_control(scene)) admit_controls(scene, &step);
      balance_values(scene, paths, i, &step);
      request_light(scene, paths, i, &step);
      if (HAS(LTC) && has_lobe_control(scene)) request_controls(scene, paths, i, 1.0f, true, &step);

      // The next direction, and Russian roulette. Further directions are stacked.
      sample_branches(scene, paths, i, count, &step);
      if (NEEDS(scene, TRANSMISSION)) enter_media(paths, i, &step.samples, step.eta);
      continue_paths(scene, paths, i, &step);
      if (NEEDS(scene, INSTANCES)) leave_instances(paths, i, &step.surfaces);
      if (revisits) end_revisits(paths, i);
    } else {
      end_paths(paths, i);
    }

    // A path that has ended goes on along the last branch that it stacked.
    take_branches(scene, paths, i, count);
  }
}

PENUMBRA_NAMESPACE_END
#endif
