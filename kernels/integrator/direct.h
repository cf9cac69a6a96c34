// Direct light with n_g emitter samples and n_f direction samples for each camera ray. Step k traces the k-th
// direction and requests the k-th shadow ray, both from the surface that the camera ray hit. Stages
// that integrators share are in step.h.
#ifndef PENUMBRA_INTEGRATOR_DIRECT_H
#define PENUMBRA_INTEGRATOR_DIRECT_H
#include "kernels/integrator/directions.h"
#include "kernels/integrator/dispersion.h"
#include "kernels/integrator/light_request.h"
#include "kernels/integrator/step.h"

PENUMBRA_NAMESPACE_BEGIN

// The stages of a step, each for LANES paths from lane i on.

/// The number of steps: the hits of the last directions are found one step after they were requested.
FN int direct_steps(const PRIVATE SceneHeader* h) {
  const int emitter_samples = h->integrator.emitter_samples, bsdf_samples = h->integrator.bsdf_samples;
  const int rays = bsdf_samples > 0 ? bsdf_samples + 1 : 1;
  return emitter_samples > rays ? emitter_samples : rays;
}

/// Random numbers for the light and direction samples of step k.
FN void direct_numbers(const PRIVATE SceneHeader* h, int k, const PRIVATE PathState* paths, int i,
                       PRIVATE float* u) {
  const uint spp = sequence_length(h);
  const int emitter_samples = h->integrator.emitter_samples, bsdf_samples = h->integrator.bsdf_samples;
  const int most = emitter_samples > bsdf_samples ? emitter_samples : bsdf_samples;
  if (k < emitter_samples)
    sample_pair(h->sampler.kind, spp, nth_point(step_point(PAIR_LIGHT), emitter_samples, k), paths, i,
                u + DIM_LIGHT_U * LANES, u + DIM_LIGHT_V * LANES);
  if (k < bsdf_samples)
    sample_pair(h->sampler.kind, spp, nth_point(step_point(PAIR_BSDF), bsdf_samples, k), paths, i,
                u + DIM_BSDF_U * LANES, u + DIM_BSDF_V * LANES);
  // Dispersion chooses a channel for each sample.
  const bool disperses = HAS(DISPERSION) && (SCENE_FEATURES(h) & FEATURE_DISPERSION) != 0;
  if ((k < bsdf_samples) | ((k < emitter_samples) & ((h->tables.lights.count > 1) | disperses)))
    sample_pair(h->sampler.kind, spp, nth_point(step_point(PAIR_CHOICE), most, k), paths, i,
                u + DIM_LIGHT_FINE * LANES, u + DIM_LOBE_CHOICE * LANES);
}

STAGE void keep_uvs(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) keep_uv(paths, i + j, load_surface(surfaces, j));
}
STAGE void load_kept_uvs(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      store_surface_uv(surfaces, j, with_kept_uv(paths, i + j, load_surface(surfaces, j)));
}

STAGE void keep_coats(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) set_surface_coat(paths, i + j, LOAD_LANE_vec3(surfaces->coat, j));
}
STAGE void load_kept_coats(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 coat = get_surface_coat(paths, i + j);
      STORE_LANE_vec3(surfaces->coat, j, coat);
    }
}

/// Step 0 keeps the surfaces that camera rays hit, if there is another step; later steps load them.
FN void use_first_surfaces(const PRIVATE Scene* scene, int k, bool is_last, const PRIVATE PathState* paths,
                           int i, PRIVATE Surfaces* surfaces) {
  if (k == 0 && !is_last) keep_surfaces(paths, i, surfaces);
  if (k > 0) load_kept_surfaces(paths, i, surfaces);
  if (NEEDS(scene, UV) && k == 0 && !is_last) keep_uvs(paths, i, surfaces);
  if (NEEDS(scene, UV) && k > 0) load_kept_uvs(paths, i, surfaces);
  if (NEEDS(scene, COAT_NORMALS) && k == 0 && !is_last) keep_coats(paths, i, surfaces);
  if (NEEDS(scene, COAT_NORMALS) && k > 0) load_kept_coats(paths, i, surfaces);
  if (NEEDS(scene, INSTANCES)) keep_at_instances(paths, i, k, surfaces);
}

/// Adds the emission that the last rays hit: camera rays if `first`, else direction samples with their MIS
/// weights.
STAGE void add_emissions_found(const PRIVATE Scene* scene, bool first, const PRIVATE PathState* paths, int i,
                               PRIVATE FoundLights* RESTRICT lights,
                               const PRIVATE Emissions* RESTRICT emissions) {
  const PRIVATE SceneHeader* h = &scene->header;
  if (first && h->integrator.hide_emitters == HIDE_MARKED) drop_hidden_lights(scene, paths, i, lights);
  const float emitter_samples = (float)h->integrator.emitter_samples;
  const float bsdf_samples = (float)h->integrator.bsdf_samples;
  const float seen = h->integrator.hide_emitters > HIDE_NOTHING ? 0.0f : 1.0f;
  const int heuristic = h->integrator.heuristic;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Emission emission = load_emission(emissions, j);
      const float by_direction = bsdf_samples * get_direction_pdf(paths, i + j);
      const float share = mis_weight(heuristic, by_direction, emitter_samples * emission.pdf);
      const bool counts = (lights->light[j] >= 0) & (first | (get_ray_tmax(paths, i + j) > 0.0f));
      const vec3 found = mul(get_throughput(paths, i + j), scale(emission.radiance, first ? seen : share));
      const vec3 before = get_radiance(paths, i + j);
      set_radiance(paths, i + j, select3(counts, add(before, found), before));
    }
}

/// Adds the emission of lights that the rays of step k found beside those of the surfaces where they ended.
/// `surfaces`: for fields that surfaces have.
FN void add_found_directly(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int k,
                           const PRIVATE Surfaces* surfaces, PRIVATE FoundLights* found) {
  Emissions emissions;
  if ((NEEDS(scene, PROJECTED) || NEEDS_LIGHT_TREE(scene)) && k > 0) {
    Surfaces left = *surfaces;
    load_kept_surfaces(paths, i, &left);
    Closures closures;
    for (int j = 0; j < LANES; j++) store_closure(&closures, j, black_closure());
    resolve_closures(scene, &left, &closures);
    if (NEEDS(scene, PROJECTED))
      project_from_surfaces(scene, families_among(&closures), &left, &closures, found);
    if (NEEDS_LIGHT_TREE(scene)) {
      LitPlaces places;
      LightScales scales;
      find_lit_places(&left, &closures, &places);
      find_light_scales(scene, &places, &scales);
      find_tree_pmfs(scene, &places, &scales, found);
    }
  }
  find_emissions(scene, found, k > 0, &emissions);
  add_emissions_found(scene, k == 0, paths, i, found, &emissions);
}

/// The same of surfaces that rays pass, in the lanes with `passes`. The surfaces are as seen from where the
/// rays started.
FN void add_passed_directly(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int k,
                            const PRIVATE Surfaces* surfaces, const PRIVATE int* passes) {
  FoundLights found;
  find_passed_lights(scene, surfaces, passes, &found);
  add_found_directly(scene, paths, i, k, surfaces, &found);
}

/// The same of suns.
FN void add_suns_directly(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int k,
                          const PRIVATE Surfaces* surfaces) {
  FoundLights found;
  for (int light = scene->header.first_sun; light < end_of_suns(scene); light++)
    if (is_sun(scene, light) && finds_sun(scene, light, surfaces, &found))
      add_found_directly(scene, paths, i, k, surfaces, &found);
}

STAGE void request_emitter_samples(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                   const PRIVATE StepLanes* RESTRICT step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const float emitter_samples = (float)h->integrator.emitter_samples,
              bsdf_samples = (float)h->integrator.bsdf_samples;
  const int kind = h->integrator.bsdf_sampling, heuristic = h->integrator.heuristic;
  const ulong by_themselves = families_with_own_directions(h);
  const bool disperses = NEEDS(scene, DISPERSION);  // then paths have a throughput, see disperse
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      const LightSample light = load_light_sample(&step->lights, j);
      const BsdfValue value = load_bsdf_value(&step->values, j);
      const Closure c = load_closure(&step->closures, j);
      const bool own = is_among(c, by_themselves);
      const float other = own ? value.pdf : direction_pdf(kind, s.shading, light.wi, value.pdf);
      const float shared = mis_weight(heuristic, emitter_samples * light.pdf, bsdf_samples * other);
      const float share = light.delta ? 1.0f : shared;
      const float weight = share / (emitter_samples * (light.pdf > 0.0f ? light.pdf : 1.0f));
      const bool lit = is_hit(s) & (light.tmax > 0.0f) & (value.pdf > 0.0f);
      const bool controlled = is_controlled(scene, c, light.of_polygon);
      const vec3 kept = select3(disperses, get_throughput(paths, i + j), make_vec3(1.0f, 1.0f, 1.0f));
      const vec3 arriving = mul(kept, scale(mul(value.f_cos, light.radiance), weight));
      request_shadow_ray(scene, paths, i + j, s, c, light, arriving, lit, controlled);
    }
}

/// Requests the direction samples as next rays.
STAGE void request_directions(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                              const PRIVATE StepLanes* RESTRICT step) {
  const float share = 1.0f / (float)scene->header.integrator.bsdf_samples;
  const bool disperses = NEEDS(scene, DISPERSION);
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      const BsdfSample next = load_bsdf_sample(&step->samples, j);
      const bool traces =
          is_hit(s) & (next.pdf > 0.0f) & !is_cut_off(scene, s, load_closure(&step->closures, j), next.wi);
      const vec3 kept = select3(disperses, get_throughput(&fields, i + j), make_vec3(1.0f, 1.0f, 1.0f));
      set_ray_origin(&fields, i + j, leave_surface(s.p, s.geometric, s.error, next.wi));
      set_ray_direction(&fields, i + j, next.wi);
      set_throughput(&fields, i + j, mul(kept, scale(next.weight, share)));
      set_ray_tmax(&fields, i + j, traces ? NO_LIMIT : -1.0f);
      set_direction_pdf(&fields, i + j, next.pdf);
      set_ray_skip(&fields, i + j, s.primitive);
    }
}

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
      if (NEEDS_LIGHT(scene, SUN)) add_suns_directly(scene, paths, i, k, &step.surfaces);
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
    if (NEEDS(scene, DISPERSION)) disperse(scene, false, paths, i, &step);

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
