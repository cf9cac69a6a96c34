// Recursive ray tracing after Whitted 1980, without recursion. At mirrors and glass both branches are
// followed, each with its exact weight. At other surfaces light is sampled as by the path integrator, and
// `bsdf_samples` directions of the hemisphere sample the rest. A path branches at its first `branch_depth`
// surfaces; beyond them it chooses one branch by its probability, as the path integrator does. The expected
// radiance is that of the path integrator. The stages are in whitted_stages.h, path_stages.h and step.h.
#ifndef PENUMBRA_INTEGRATOR_WHITTED_H
#define PENUMBRA_INTEGRATOR_WHITTED_H
#include "kernels/integrator/whitted_stages.h"

PENUMBRA_NAMESPACE_BEGIN

/// Processes the surfaces where the paths' last rays ended.
CALLED_FN void step_whitted(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count, int steps,
                            const PRIVATE SlotState* slots) {
  const PRIVATE SceneHeader* h = &scene->header;
  const bool balances = h->integrator.bsdf_samples > 0, revisits = h->integrator.bsdf_samples > 1;
  StepLanes step;
  start_step(&step);
  for (int i = 0; i < count; i += LANES) {
    if (steps == 0) start_branches(paths, i);
    const bool scatters = any_scatters(h, paths, i);
    if (scatters) path_numbers(h, any_roulette(h, paths, i), paths, i, step.u);

    // The surfaces that the last rays hit, and their BSDFs.
    find_surfaces(scene, paths, i, &step.surfaces);
    resolve_step_closures(scene, &step);
    if (steps == 0) record_first_hits(scene, &step.surfaces, &step.closures, paths, i, slots);

    // Emission that the rays hit, weighted against the light samples that could have found it.
    const bool finds = any_finds_light(scene, &step.surfaces);
    if (finds) find_lights(scene, &step.surfaces, &step.found);
    request_whitted_lights(scene, scatters, finds, &step, paths, i);
    if (finds) find_emissions(scene, &step.found, balances & (steps > 0), &step.emissions);
    if (finds & revisits) drop_found_again(paths, i, &step.found);
    if (NEEDS(scene, POLYGONS) && finds) drop_controlled(paths, i, &step.emissions, &step.found);
    if (NEEDS(scene, POLYGONS)) note_controlled(scene, paths, i, &step.closures);
    if (finds) add_emissions(scene, paths, i, &step.found, &step.emissions);

    if (scatters) {
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
