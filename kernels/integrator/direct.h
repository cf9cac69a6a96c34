// Direct light with n_g emitter samples and n_f direction samples for each camera ray, in steps: step k
// traces the k-th direction and asks for the k-th shadow ray, all from the surface that the camera ray hit.
#ifndef PENUMBRA_INTEGRATOR_DIRECT_H
#define PENUMBRA_INTEGRATOR_DIRECT_H
#include "kernels/integrator/light_request.h"

PENUMBRA_NAMESPACE_BEGIN

/// Density of the scene's way of choosing directions about the surface's shading normal: on both sides where
/// light comes `through`.
FN float direction_pdf(int kind, vec3 n, vec3 wi, bool through, float bsdf_pdf) {
  const float along = dot3(n, wi), cosine = through ? 0.5f * FABS(along) : max_f(along, 0.0f);
  const float uniform = through ? 0.25f * INV_PI_F : 0.5f * INV_PI_F;
  const float pdf = kind == DIRECTION_COSINE ? cosine * INV_PI_F : (cosine > 0.0f ? uniform : 0.0f);
  return kind == DIRECTION_BSDF ? bsdf_pdf : pdf;
}

#if HAS(DIRECT)
/// Random numbers for a step's light and direction samples.
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
  if ((k < bsdf_samples) | ((k < emitter_samples) & (h->tables.lights.count > 1)))
    sample_pair(h->sampler.kind, spp, nth_point(step_point(PAIR_CHOICE), most, k), paths, i,
                u + DIM_LIGHT_FINE * LANES, u + DIM_LOBE_CHOICE * LANES);
}

STAGE void keep_surfaces(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) keep_surface(paths, i + j, load_surface(surfaces, j));
}
STAGE void load_kept_surfaces(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_surface_hit(surfaces, j, kept_surface(paths, i + j));
}
  #if HAS(UV)
STAGE void keep_uvs(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) keep_uv(paths, i + j, load_surface(surfaces, j));
}
STAGE void load_kept_uvs(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      store_surface_uv(surfaces, j, with_kept_uv(paths, i + j, load_surface(surfaces, j)));
}
  #endif

/// Adds what the last rays found: at `first` the camera's, then those of the direction samples.
STAGE void add_emissions_found(const PRIVATE Scene* scene, bool first, const PRIVATE PathState* paths, int i,
                               const PRIVATE FoundLights* RESTRICT lights,
                               const PRIVATE Emissions* RESTRICT emissions) {
  const PRIVATE SceneHeader* h = &scene->header;
  const float emitter_samples = (float)h->integrator.emitter_samples;
  const float bsdf_samples = (float)h->integrator.bsdf_samples;
  const float seen = h->integrator.hide_emitters != HIDE_NOTHING ? 0.0f : 1.0f;
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

/// Before a step's samples ask for rays: none, and a path goes on if a step is left and there is a surface.
STAGE void begin_steps(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces,
                       bool is_last) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      set_ray_tmax(paths, i + j, -1.0f);
      set_shadow_tmax(paths, i + j, -1.0f);
      set_alive(paths, i + j, (surfaces->primitive[j] >= 0) & !is_last);
    }
}

STAGE void request_emitter_samples(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                   const PRIVATE StepLanes* RESTRICT step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const float emitter_samples = (float)h->integrator.emitter_samples,
              bsdf_samples = (float)h->integrator.bsdf_samples;
  const int kind = h->integrator.bsdf_sampling, heuristic = h->integrator.heuristic;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      const LightSample light = load_light_sample(&step->lights, j);
      const BsdfValue value = load_bsdf_value(&step->values, j);
      const bool through = lets_light_through(step->closures.family[j]);
      const float other = direction_pdf(kind, s.shading, light.wi, through, value.pdf);
      const float shared = mis_weight(heuristic, emitter_samples * light.pdf, bsdf_samples * other);
      const float share = light.delta ? 1.0f : shared;
      const float weight = share / (emitter_samples * (light.pdf > 0.0f ? light.pdf : 1.0f));
      const bool lit = is_hit(s) & (light.tmax > 0.0f) & (value.pdf > 0.0f);
      const bool controlled = is_controlled(scene, load_closure(&step->closures, j), light.of_polygon);
      const vec3 arriving = scale(mul(value.f_cos, light.radiance), weight);
      request_shadow_ray(scene, paths, i + j, s, light, arriving, lit, controlled);
    }
}

STAGE void direction_samples(int kind, const PRIVATE Surfaces* RESTRICT surfaces,
                             const PRIVATE int* RESTRICT families, const PRIVATE float* RESTRICT uv,
                             const PRIVATE float* RESTRICT choice, PRIVATE float* RESTRICT wi) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const vec3 n = LOAD_LANE_vec3(surfaces->shading, j);
      const vec3 by_cosine = sample_cosine_hemisphere(n, uv[j], uv[LANES + j]);
      const vec3 by_area = sample_uniform_hemisphere(n, uv[j], uv[LANES + j]);
      const vec3 above = select3(kind == DIRECTION_COSINE, by_cosine, by_area);
      const vec3 below = add_scaled(above, -2.0f * dot3(n, above), n);
      const bool turned = lets_light_through(families[j]) & (choice[j] < 0.5f);
      STORE_LANE_vec3(wi, j, select3(turned, below, above));
    }
}

STAGE void weigh_directions(int kind, const PRIVATE Surfaces* RESTRICT surfaces,
                            const PRIVATE int* RESTRICT families, const PRIVATE float* RESTRICT wi,
                            const PRIVATE BsdfValues* RESTRICT values,
                            PRIVATE BsdfSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const BsdfValue value = load_bsdf_value(values, j);
      BsdfSample s = no_bsdf_sample();
      s.wi = LOAD_LANE_vec3(wi, j);
      const bool through = lets_light_through(families[j]);
      const float pdf = direction_pdf(kind, LOAD_LANE_vec3(surfaces->shading, j), s.wi, through, value.pdf);
      s.pdf = value.pdf > 0.0f ? pdf : 0.0f;
      s.weight = scale(value.f_cos, 1.0f / (pdf > 0.0f ? pdf : 1.0f));
      store_bsdf_sample(samples, j, s);
    }
}

/// Directions that the scene does not leave to the BSDFs, and the closures' values for them, as samples.
FN void choose_directions(const PRIVATE Scene* scene, PRIVATE StepLanes* step) {
  const PRIVATE SceneHeader* h = &scene->header;
  float wi[3 * LANES];
  BsdfValues values;
  const PRIVATE int* families = step->closures.family;
  direction_samples(h->integrator.bsdf_sampling, &step->surfaces, families, step->u + DIM_BSDF_U * LANES,
                    step->u + DIM_LOBE_CHOICE * LANES, wi);
  eval_bsdfs(scene, step->families, &step->closures, &step->surfaces, wi, &values);
  weigh_directions(h->integrator.bsdf_sampling, &step->surfaces, families, wi, &values, &step->samples);
}

/// Direction samples as the next rays.
STAGE void request_directions(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                              const PRIVATE StepLanes* RESTRICT step) {
  const float share = 1.0f / (float)scene->header.integrator.bsdf_samples;
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      const BsdfSample next = load_bsdf_sample(&step->samples, j);
      const bool traces = is_hit(s) & (next.pdf > 0.0f) & !is_beneath(s, next.wi);
      set_ray_origin(&fields, i + j, leave_surface(s.p, s.geometric, s.error, next.wi));
      set_ray_direction(&fields, i + j, next.wi);
      set_throughput(&fields, i + j, scale(next.weight, share));
      set_ray_tmax(&fields, i + j, traces ? NO_LIMIT : -1.0f);
      set_direction_pdf(&fields, i + j, next.pdf);
      set_ray_skip(&fields, i + j, s.primitive);
    }
}

/// The k-th step.
FN void step_direct(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count, int k,
                    const PRIVATE SlotState* slots) {
  const PRIVATE SceneHeader* h = &scene->header;
  const bool emits = k < h->integrator.emitter_samples, scatters = k < h->integrator.bsdf_samples;
  const bool balances = h->integrator.bsdf_samples > 0;
  const int rays = balances ? h->integrator.bsdf_samples + 1 : 1;
  const bool is_last = k + 1 >= (h->integrator.emitter_samples > rays ? h->integrator.emitter_samples : rays);
  const LightRequest request = light_request(scene, false, emits, k == 0, balances);
  StepLanes step;
  start_step(&step);
  for (int i = 0; i < count; i += LANES) {
    // At first the last rays are the camera's.
    bool finds = false;
    if (k == 0 || balances) {
      find_surfaces(scene, paths, i, &step.surfaces);
      finds = any_finds_light(scene, &step.surfaces);
      if (finds) find_lights(scene, &step.surfaces, &step.found);
    }
    if (k == 0) keep_surfaces(paths, i, &step.surfaces);
    if (k > 0) load_kept_surfaces(paths, i, &step.surfaces);
  #if HAS(UV)
    if (NEEDS(scene, UV) && k == 0) keep_uvs(paths, i, &step.surfaces);
    if (NEEDS(scene, UV) && k > 0) load_kept_uvs(paths, i, &step.surfaces);
  #endif
    resolve_step_closures(scene, &step);
  #if HAS(LAYERS)
    if (NEEDS(scene, LAYERS) && k == 0) record_layers(&step.surfaces, &step.closures, paths, i, slots);
  #endif
    direct_numbers(h, k, paths, i, step.u);
    request_lights(scene, request, finds, &step, paths, i);
    if (finds) {
      find_emissions(scene, &step.found, k > 0, &step.emissions);
      add_emissions_found(scene, k == 0, paths, i, &step.found, &step.emissions);
    }
    begin_steps(paths, i, &step.surfaces, is_last);
    if (step.families == 0u) continue;  // nothing scatters
    if (emits) {
      sample_step_lights(scene, &step);
      eval_bsdfs(scene, step.families, &step.closures, &step.surfaces, step.lights.wi, &step.values);
      request_emitter_samples(scene, paths, i, &step);
    }
    if (scatters) {
      if (h->integrator.bsdf_sampling == DIRECTION_BSDF)
        sample_bsdfs(scene, step.families, &step.closures, &step.surfaces, step.u + DIM_BSDF_U * LANES,
                     step.u + DIM_LOBE_CHOICE * LANES, &step.samples);
      else
        choose_directions(scene, &step);
      request_directions(scene, paths, i, &step);
    }
  }
}
#endif

PENUMBRA_NAMESPACE_END
#endif
