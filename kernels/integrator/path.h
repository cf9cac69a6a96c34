// Path tracing with next-event estimation and multiple importance sampling (J. T. Kajiya, "The rendering
// equation", 1986; E. Veach, "Robust Monte Carlo methods for light transport simulation", 1997).
//
// An integrator is a step function. Given the hits of the paths' last rays, it adds the emission that they
// found, and requests at most one shadow ray and one next ray for each path. It never traces rays:
// block/block.h does so between the steps. LANES paths go through each stage together. A stage that the scene
// does not need is not called (NEEDS). The stages are in path_stages.h and step.h.
#ifndef PENUMBRA_INTEGRATOR_PATH_H
#define PENUMBRA_INTEGRATOR_PATH_H
#include "kernels/integrator/dispersion.h"
#include "kernels/integrator/flat_glass.h"
#include "kernels/integrator/interiors.h"
#include "kernels/integrator/path_stages.h"
#include "kernels/photon/photon_chains.h"

PENUMBRA_NAMESPACE_BEGIN

/// Processes the next vertex of `count` paths; each has at most `vertices` vertices so far.
CALLED_FN void step_paths(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count, int vertices,
                          const PRIVATE SlotState* slots) {
  const PRIVATE SceneHeader* h = &scene->header;
  const bool balances = h->integrator.direct_sampling == SAMPLING_MIS;
  StepLanes step;
  start_step(&step);
  for (int i = 0; i < count; i += LANES) {
    const bool scatters = any_scatters(scene, paths, i), interiors = NEEDS_INTERIORS(scene);
    const bool roulette = (vertices + 1 >= h->integrator.rr_depth) | interiors;
    if (scatters) path_numbers(h, roulette, paths, i, step.u);

    // The surfaces that the last rays hit, and their BSDFs.
    find_surfaces(scene, paths, i, &step.surfaces);
    resolve_step_closures(scene, &step);
    if (interiors) note_inner(scene, paths, i, &step);
    if (vertices == 0) record_first_hits(scene, &step.surfaces, &step.closures, paths, i, slots);

    // Emission that the rays hit, weighted against the light samples that could have found it.
    if (NEEDS_LIGHT(scene, SUN)) add_suns_by_path(scene, paths, i, vertices, &step.surfaces);
    const bool finds = any_finds_light(scene, &step.surfaces);
    const bool emits = scatters & takes_light_samples(interiors ? lit_families(&step) : step.families);
    if (finds) find_lights(scene, &step.surfaces, &step.found);
    request_lights(scene, light_request(scene, true, emits, emits, balances), finds, &step, paths, i);
    if (finds) find_emissions(scene, &step.found, balances & (vertices > 0), &step.emissions);
    if (NEEDS(scene, POLYGONS) && finds) drop_controlled(paths, i, &step.emissions, &step.found);
    if (NEEDS(scene, POLYGONS)) note_controlled(scene, paths, i, &step.closures);
    if (NEEDS(scene, PARTS) && finds) drop_found_parts(scene, paths, i, &step.found);
    if (NEEDS_PHOTONS(scene) && finds) drop_photon_emission(paths, i, &step.found);
    if (finds) add_emissions(scene, paths, i, &step.found, &step.emissions);
    if (NEEDS_SPLIT_LIGHT(scene) && vertices == 1) note_direct(paths, i);
    if (!scatters) {
      end_paths(paths, i);
      continue;
    }
    if (NEEDS(scene, DISPERSION)) disperse(scene, true, paths, i, &step);

    // Next-event estimation: a point on a light, and the shadow ray to it.
    if (emits) {
      sample_step_lights(scene, &step);
      if (interiors) drop_inner_samples(&step);
      if (NEEDS(scene, PARTS)) drop_sampled_parts(scene, paths, i, &step.lights);
      if (NEEDS_PHOTONS(scene)) drop_photon_samples(paths, i, &step.closures, &step.lights);
      eval_bsdfs(scene, step.families, &step.closures, &step.surfaces, step.lights.wi, &step.values);
      if (HAS(LTC) && has_lobe_control(scene)) admit_controls(scene, &step);
      request_light(scene, paths, i, &step);
      if (HAS(LTC) && has_lobe_control(scene)) request_controls(scene, paths, i, 1.0f, true, &step);
      if (NEEDS_MEDIA(scene)) request_through_media(scene, paths, i, &step);
      if (NEEDS_GLOWS(scene)) request_glows(scene, paths, i, &step);
      if (NEEDS(scene, FLAT_GLASS)) request_through_glass(paths, i, &step.lights);
    } else {
      request_no_light(paths, i);
    }

    // Indirect light from photon maps.
    if (NEEDS_PHOTONS(scene)) add_photons(scene, paths, i, &step);

    // The next direction, by BSDF sampling, and Russian roulette.
    sample_bsdfs(scene, step.families, &step.closures, &step.surfaces, step.u + DIM_BSDF_U * LANES,
                 step.u + DIM_LOBE_CHOICE * LANES, &step.samples);
    shade_bumps(scene, &step.surfaces, &step.samples);
    if (interiors) go_inside(scene, paths, i, &step);
    if (NEEDS(scene, TRANSMISSION)) enter_media(paths, i, &step.samples, step.eta);
    continue_paths(scene, paths, i, &step);
    if (NEEDS(scene, FLAT_GLASS)) follow_through_glass(scene, paths, i, &step.surfaces);
    if (NEEDS_PHOTONS(scene)) follow_chains(scene, paths, i, &step.surfaces, &step.closures);
    if (NEEDS_MEDIA(scene)) go_on_in_media(paths, i, &step.surfaces);
    if (NEEDS(scene, INSTANCES)) leave_instances(paths, i, &step.surfaces);
  }
}

PENUMBRA_NAMESPACE_END
#endif
