// Direct light with n_g emitter samples and n_f direction samples for each camera ray. Step k traces the k-th
// direction and requests the k-th shadow ray, both from the surface that the camera ray hit. The stages are
// in direct_stages.h and step.h.
#ifndef PENUMBRA_INTEGRATOR_DIRECT_H
#define PENUMBRA_INTEGRATOR_DIRECT_H
#include "kernels/integrator/direct_stages.h"

PENUMBRA_NAMESPACE_BEGIN

/// The k-th step.
CALLED_FN void step_direct(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count, int k,
                           const PRIVATE SlotState* slots) {
  const PRIVATE SceneHeader* h = &scene->header;
  const bool emits = k < h->integrator.emitter_samples, scatters = k < h->integrator.bsdf_samples;
  const bool balances = h->integrator.bsdf_samples > 0, is_last = k + 1 >= direct_steps(h);
  const LightRequest request = light_request(scene, false, emits, k == 0, balances);
  StepLanes step;
  start_step(&step);
  for (int i = 0; i < count; i += LANES) {
    direct_numbers(h, k, paths, i, step.u);

    // The lights that the last rays hit: camera rays in step 0, then the last directions.
    bool finds = false;
    if (k == 0 || balances) {
      find_surfaces(scene, paths, i, &step.surfaces);
      finds = any_finds_light(scene, &step.surfaces);
      if (finds) find_lights(scene, &step.surfaces, &step.found);
    }

    // The surfaces that the camera rays hit, and their BSDFs.
    use_first_surfaces(scene, k, is_last, paths, i, &step.surfaces);
    resolve_step_closures(scene, &step);
    if (k == 0) record_first_hits(scene, &step.surfaces, &step.closures, paths, i, slots);

    // Emission that the last rays hit, weighted against the light samples that could have found it.
    request_lights(scene, request, finds, &step, paths, i);
    if (finds) find_emissions(scene, &step.found, k > 0, &step.emissions);
    if (finds) add_emissions_found(scene, k == 0, paths, i, &step.found, &step.emissions);
    begin_steps(paths, i, &step.surfaces, is_last);
    if (step.families == 0u) continue;  // nothing scatters

    // The k-th point on a light, and the shadow ray to it.
    if (emits) {
      sample_step_lights(scene, &step);
      eval_bsdfs(scene, step.families, &step.closures, &step.surfaces, step.lights.wi, &step.values);
      if (HAS(LTC) && has_lobe_control(scene)) admit_controls(scene, &step);
      request_emitter_samples(scene, paths, i, &step);
      if (HAS(LTC) && has_lobe_control(scene))
        request_controls(scene, paths, i, (float)h->integrator.emitter_samples, false, &step);
    }

    // The k-th direction.
    if (scatters) sample_directions(scene, &step);
    if (scatters) request_directions(scene, paths, i, &step);
  }
}

PENUMBRA_NAMESPACE_END
#endif
