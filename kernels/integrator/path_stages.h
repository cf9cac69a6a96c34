// The stages of a path tracer's step (path.h), each for LANES paths from lane i on, and Russian roulette.
#ifndef PENUMBRA_INTEGRATOR_PATH_STAGES_H
#define PENUMBRA_INTEGRATOR_PATH_STAGES_H
#include "kernels/integrator/light_request.h"
#include "kernels/medium/medium_state.h"
#include "kernels/photon/photon_surfaces.h"

PENUMBRA_NAMESPACE_BEGIN

// Russian roulette: see roulette_survival.
#define ROULETTE_LASTS 100.0f

/// Survival probability of the k-th round of Russian roulette, k = 0, 1 ... It is larger than the throughput
/// t: this costs some steps and saves more variance. sqrt(2 t) was the best of t, sqrt t, 2 t, 4 t, the
/// fourth root of t, mean and luminance. The cap ends paths that lose nothing, where the albedo is 1: n
/// rounds are survived with probability at most (100 / n)^2, so weights grow only like n^2, which any albedo
/// below 1 outweighs. A constant cap would have infinite variance for albedos above sqrt(cap). `least`: what
/// a dielectric surface keeps of the throughput, 0 at others. Glass takes little, and light that is only seen
/// through glass decides the noise of many images: with this, it is found as often behind glass as before it.
FN float roulette_survival(float throughput, float least, int k) {
  return min_f(max_f(SQRT(2.0f * throughput), least), 1.0f - 2.0f / ((float)k + ROULETTE_LASTS));
}

/// Survival probability of a path that scattered to `depth`. `strongest` is its largest throughput component,
/// in a medium of relative refractive index `eta`. Radiance scales with the square of the index, and the
/// radiance that arrives at the camera does not; eta^2 compensates.
FN float path_survival(int rr_depth, int depth, float strongest, float eta, float least) {
  const bool roulette = depth >= rr_depth;
  const int throws = roulette ? depth - rr_depth : 0;
  return roulette ? roulette_survival(strongest * (eta * eta), least, throws) : 1.0f;
}

/// Random numbers for a step of LANES paths from lane i on. Numbers that the step does not need are not
/// written.
JIT_CALLED_FN void path_numbers(const PRIVATE SceneHeader* h, bool roulette, const PRIVATE PathState* paths,
                                int i, PRIVATE float* u) {
  const uint spp = sequence_length(h);
  sample_pair(h->sampler.kind, spp, step_point(PAIR_LIGHT), paths, i, u + DIM_LIGHT_U * LANES,
              u + DIM_LIGHT_V * LANES);
  sample_pair(h->sampler.kind, spp, step_point(PAIR_BSDF), paths, i, u + DIM_BSDF_U * LANES,
              u + DIM_BSDF_V * LANES);
  const bool chooses = h->tables.lights.count > 1;  // a single light needs no second number
  if (chooses | ((NEEDED(FAMILIES, h->families) & families_with(SEVERAL_LOBES)) != 0u))
    sample_pair(h->sampler.kind, spp, step_point(PAIR_CHOICE), paths, i,
                u + (chooses ? DIM_LIGHT_FINE : DIM_UNUSED) * LANES, u + DIM_LOBE_CHOICE * LANES);
  if (roulette)
    sample_pair(h->sampler.kind, spp, step_point(PAIR_END), paths, i, u + DIM_ROULETTE * LANES,
                u + DIM_FREE_FLIGHT * LANES);
}

/// Survival probability of a path whose last `inner` vertices are inside a material. The cap is milder than
/// that of roulette_survival, since long walks carry much of the light: n vertices are survived with
/// probability at most 100 / n.
FN float inner_survival(float strongest, float eta, int inner) {
  return min_f(SQRT(2.0f * strongest) * eta, 1.0f - 1.0f / ((float)inner + ROULETTE_LASTS));
}

/// Whether any of LANES paths from lane i on may scatter where its last ray ended.
FN bool any_scatters(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  const int max_depth = scene->header.integrator.max_depth;
  const bool interiors = NEEDS_INTERIORS(scene);
  int any = 0;
  for (int j = i; j < i + LANES; j++) {
    const int depth = get_depth(paths, j) - (interiors ? get_inner(paths, j) : 0);
    any |= ((get_hit(paths, j) != NOTHING_HIT) & (depth + 1 < max_depth)) ? 1 : 0;
  }
  return any != 0;
}

/// Whether light samples may count at closures of these families: not if all are delta.
FN bool takes_light_samples(ulong families) { return (families & ~families_with(DELTA)) != 0u; }

STAGE void request_no_light(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_shadow_tmax(paths, j, -1.0f);
}

/// Ends LANES paths of which none scatters.
STAGE void end_paths(const PRIVATE PathState* paths, int i) {
  request_no_light(paths, i);
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_alive(paths, j, false);
}

/// Drops emission that rays hit, if the surface that they left uses the closed form of that light: only
/// next-event estimation may sample it. Emission found by delta directions is kept, since next-event
/// estimation never samples those.
STAGE void drop_controlled(const PRIVATE PathState* paths, int i, const PRIVATE Emissions* RESTRICT emissions,
                           PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Emission emission = load_emission(emissions, j);
      const bool dropped = (get_depth(paths, i + j) > 0) & get_left_controlled(paths, i + j) &
                           emission.of_polygon & (get_direction_pdf(paths, i + j) != DELTA_PDF);
      found->light[j] = dropped ? -1 : found->light[j];
    }
}

/// Stores whether the next rays leave such surfaces.
STAGE void note_controlled(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                           const PRIVATE Closures* RESTRICT closures) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      set_left_controlled(paths, i + j, is_controlled(scene, load_closure(closures, j), true));
}

/// Whether light that scattered at `bounces` surfaces and was found by that technique is kept.
FN bool is_kept_part(const PRIVATE SceneHeader* h, int bounces, int technique) {
  const int only = h->integrator.only_technique;
  return ((h->integrator.only_bounces < 0) | (h->integrator.only_bounces == bounces)) &
         ((only == TECHNIQUE_ALL) | (only == technique));
}

/// Drops emission that the last rays found.
STAGE void drop_found_parts(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                            PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool kept = is_kept_part(&scene->header, get_depth(paths, i + j), TECHNIQUE_BSDF);
      found->light[j] = kept ? found->light[j] : -1;
    }
}

/// Drops samples of emitters: no shadow rays are requested.
STAGE void drop_sampled_parts(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                              PRIVATE LightSamples* RESTRICT lights) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool kept = is_kept_part(&scene->header, get_depth(paths, i + j) + 1, TECHNIQUE_EMITTER);
      lights->tmax[j] = kept ? lights->tmax[j] : -1.0f;
    }
}

/// Drops emission that camera rays found and the camera does not see.
STAGE void drop_hidden_lights(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                              PRIVATE FoundLights* RESTRICT found) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int light = found->light[j];
      const bool hidden =
          (get_depth(paths, i + j) == 0) & (scene->lights[light >= 0 ? light : 0].unseen == UNSEEN_BY_CAMERA);
      found->light[j] = hidden ? -1 : light;
    }
}

/// Adds the emission that the last rays found.
STAGE void add_emissions(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                         PRIVATE FoundLights* RESTRICT lights, const PRIVATE Emissions* RESTRICT emissions) {
  if (scene->header.integrator.hide_emitters == HIDE_MARKED) drop_hidden_lights(scene, paths, i, lights);
  const int sampling = scene->header.integrator.direct_sampling,
            heuristic = scene->header.integrator.heuristic;
  const float seen = scene->header.integrator.hide_emitters > HIDE_NOTHING ? 0.0f : 1.0f;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Emission emission = load_emission(emissions, j);
      const float pdf = get_direction_pdf(paths, i + j);
      // Behind flat glass, only light from infinity was sampled.
      const bool unsampled = (pdf < 0.0f) & (get_hit(paths, i + j) != NOTHING_HIT);
      const bool alone = (sampling == SAMPLING_BSDF_ONLY) | (pdf == DELTA_PDF) | unsampled;
      const float bsdf_weight = alone                      ? 1.0f
                                : sampling == SAMPLING_MIS ? mis_weight(heuristic, FABS(pdf), emission.pdf)
                                                           : 0.0f;
      const float weight = get_depth(paths, i + j) > 0 ? bsdf_weight : seen;
      const vec3 found = mul(get_throughput(paths, i + j), scale(emission.radiance, weight));
      const vec3 before = get_radiance(paths, i + j);
      set_radiance(paths, i + j, select3(lights->light[j] >= 0, add(before, found), before));
    }
}

/// Notes the light that paths have found before they scatter a second time: emission that the camera sees,
/// and all light that scattered once.
STAGE void note_direct(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_direct(paths, j, get_radiance(paths, j));
}

/// Adds the emission of lights that rays of the `step`-th step found beside those of the surfaces where they
/// ended. Light samples of the places that they left are not yet requested.
FN void add_found_by_path(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int step,
                          PRIVATE FoundLights* found) {
  const bool balances = scene->header.integrator.direct_sampling == SAMPLING_MIS;
  Emissions emissions;
  if (NEEDS(scene, PROJECTED) && balances) project_from_left(scene, paths, i, found);
  if (NEEDS_LIGHT_TREE(scene) && balances) find_previous_pmfs(scene, paths, i, found);
  find_emissions(scene, found, balances & (step > 0), &emissions);
  if (NEEDS(scene, POLYGONS)) drop_controlled(paths, i, &emissions, found);
  if (NEEDS(scene, PARTS)) drop_found_parts(scene, paths, i, found);
  if (NEEDS_PHOTONS(scene)) drop_photon_emission(paths, i, found);
  add_emissions(scene, paths, i, found, &emissions);
}

/// The same of surfaces that rays pass, in the lanes with `passes`. The surfaces are as seen from where the
/// rays started.
FN void add_passed_by_path(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int step,
                           const PRIVATE Surfaces* surfaces, const PRIVATE int* passes) {
  FoundLights found;
  find_passed_lights(scene, surfaces, passes, &found);
  add_found_by_path(scene, paths, i, step, &found);
}

/// The same of suns.
FN void add_suns_by_path(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int step,
                         const PRIVATE Surfaces* surfaces) {
  FoundLights found;
  for (int k = scene->header.first_sun; k < end_of_suns(scene); k++)
    if (is_sun(scene, k) && finds_sun(scene, k, surfaces, &found))
      add_found_by_path(scene, paths, i, step, &found);
}

STAGE void request_light(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                         const PRIVATE StepLanes* RESTRICT step) {
  const int sampling = scene->header.integrator.direct_sampling,
            heuristic = scene->header.integrator.heuristic;
  // In media, the MIS weight is applied later, when the transmittance is known.
  const bool balances = sampling == SAMPLING_MIS && !NEEDS_MEDIA(scene);
  const int max_depth = scene->header.integrator.max_depth;
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      const LightSample light = load_light_sample(&step->lights, j);
      const BsdfValue value = load_bsdf_value(&step->values, j);
      const float shared = balances ? mis_weight(heuristic, light.pdf, value.pdf) : 1.0f;
      const Closure c = load_closure(&step->closures, j);
      const bool controlled = is_controlled(scene, c, light.of_polygon);
      const bool alone = light.delta | controlled;
      const float weight = (alone ? 1.0f : shared) / (light.pdf > 0.0f ? light.pdf : 1.0f);
      const bool scatters = is_hit(s) & (get_depth(&fields, i + j) - step->inner[j] + 1 < max_depth);
      const bool lit = scatters & (light.tmax > 0.0f) & (value.pdf > 0.0f) &
                       ((sampling != SAMPLING_BSDF_ONLY) | light.delta);
      const vec3 arriving =
          mul(get_throughput(&fields, i + j), scale(mul(value.f_cos, light.radiance), weight));
      request_shadow_ray(scene, &fields, i + j, s, c, light, arriving, lit, controlled);
    }
}

/// A path's first ray is at the relative refractive index 1.
STAGE void start_media(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_eta(paths, j, 1.0f);
}

/// Updates the refractive indices for the next rays.
STAGE void enter_media(const PRIVATE PathState* paths, int i, const PRIVATE BsdfSamples* RESTRICT samples,
                       PRIVATE float* RESTRICT etas) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float eta = get_eta(paths, i + j) * samples->eta[j];
      set_eta(paths, i + j, eta);
      etas[j] = eta;
    }
}

/// The media in which shadow rays start, and the pdf ratio for the MIS weights in weigh_shadow_rays.
STAGE void request_through_media(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                 const PRIVATE StepLanes* RESTRICT step) {
  const bool balances = scene->header.integrator.direct_sampling == SAMPLING_MIS;
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightSample light = load_light_sample(&step->lights, j);
      const bool controlled = is_controlled(scene, load_closure(&step->closures, j), light.of_polygon);
      const bool behind = dot3(LOAD_LANE_vec3(step->surfaces.geometric, j), light.wi) < 0.0f;
      set_shadow_media(&fields, i + j,
                       select_media(behind, get_beyond(&fields, i + j), get_media(&fields, i + j)));
      const bool shares = balances & !(light.delta | controlled) & (light.pdf > 0.0f);
      set_shadow_balance(&fields, i + j, shares ? step->values.pdf[j] / light.pdf : 0.0f);
    }
}

/// Weighs samples of points in media against the directions in which rays find the same light, and notes the
/// media to which shadow rays lead.
STAGE void request_glows(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                         const PRIVATE StepLanes* RESTRICT step) {
  const int heuristic = scene->header.integrator.heuristic;
  for (int j = 0; j < LANES; j++) {  // no lane loop: few scenes have such lights
    const LightSample light = load_light_sample(&step->lights, j);
    const bool glows = scene->lights[light.light].kind == LIGHT_MEDIUM;
    set_shadow_glow(paths, i + j, glows ? glow_of(scene, light.light)->medium : -1);
    if (!glows || !(get_shadow_tmax(paths, i + j) > 0.0f)) continue;
    const float weight = mis_weight(heuristic, light.pdf, step->values.pdf[j]);
    set_shadow_radiance(paths, i + j, scale(get_shadow_radiance(paths, i + j), weight));
  }
}

/// The media in which the next rays start.
STAGE void go_on_in_media(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool behind =
          dot3(LOAD_LANE_vec3(surfaces->geometric, j), get_ray_direction(&fields, i + j)) < 0.0f;
      set_media(&fields, i + j, select_media(behind, get_beyond(&fields, i + j), get_media(&fields, i + j)));
    }
}

/// The next ray of path i, in a direction that the surface's BSDF sampled. `alive`: the path goes on.
FN void set_next_ray(const PRIVATE PathState* paths, int i, Surface s, BsdfSample next, vec3 throughput,
                     bool alive) {
  set_ray_origin(paths, i, leave_surface(s.p, s.geometric, s.error, next.wi));
  set_ray_direction(paths, i, next.wi);
  set_throughput(paths, i, throughput);
  set_ray_tmax(paths, i, NO_LIMIT);
  set_direction_pdf(paths, i, next.pdf);
  set_ray_skip(paths, i, s.primitive);
  set_depth(paths, i, get_depth(paths, i) + 1);
  set_alive(paths, i, alive);
}

/// Requests the next rays, or ends the paths.
STAGE void continue_paths(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          const PRIVATE StepLanes* RESTRICT step) {
  const int max_depth = scene->header.integrator.max_depth, rr_depth = scene->header.integrator.rr_depth;
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      const BsdfSample next = load_bsdf_sample(&step->samples, j);
      const bool within = step->within[j] != 0;
      const int depth = get_depth(&fields, i + j) - step->inner[j] + (within ? 0 : 1);
      const vec3 throughput = mul(get_throughput(&fields, i + j), next.weight);
      const float strongest = max_component(throughput);
      const Closure c = load_closure(&step->closures, j);
      const float kept = is_among(c, DIELECTRICS) ? max_component(next.weight) * (next.eta * next.eta) : 0.0f;
      const float at_surface = path_survival(rr_depth, depth, strongest, step->eta[j], kept);
      const float inside = inner_survival(strongest, step->eta[j], step->inner[j]);
      const float survival = within ? inside : at_surface;
      const bool alive = is_hit(s) & (depth < max_depth) & (next.pdf > 0.0f) & (strongest > 0.0f) &
                         !is_cut_off(scene, s, c, next.wi) & (lane_number(step, DIM_ROULETTE, j) < survival);
      set_next_ray(&fields, i + j, s, next, scale(throughput, 1.0f / (alive ? survival : 1.0f)), alive);
    }
}

PENUMBRA_NAMESPACE_END
#endif
