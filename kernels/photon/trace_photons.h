// Photon paths: from lights into the scene, scattered like paths of the camera, and stored where they meet a
// surface with a diffuse part or scatter in a medium (Jensen 1996). The first arrival is not stored: light
// samples find direct light. A photon is a pure function of the scene, the seed, the map and its index.
#ifndef PENUMBRA_TRACE_PHOTONS_H
#define PENUMBRA_TRACE_PHOTONS_H
#include "kernels/block/block_compact.h"
#include "kernels/block/block_see_through.h"
#include "kernels/block/block_sort.h"
#include "kernels/block/block_trace.h"
#include "kernels/integrator/dispersion.h"
#include "kernels/light/light_emission.h"
#include "kernels/motion/shutter.h"
#include "kernels/photon/photon_chains.h"
#include "kernels/photon/photon_task.h"

PENUMBRA_NAMESPACE_BEGIN

/// The scene with the random sequence of these photons.
FN Scene scene_of_photons(Scene scene, const PRIVATE PhotonTask* task) {
  const uint seed = sequence_seed(scene.header.sampler.seed, task->sequence);
  scene.header.sampler.seed = hash_uint(seed ^ hash_uint(task->map ^ 0x70686f74u));
  scene.header.sampler.spp = (uint)task->paths;
  return scene;
}

/// Photon paths `first` ... leave their lights. Lanes past `count` repeat the last one.
STAGE void number_photons(const PRIVATE Scene* scene, int first, int count, const PRIVATE PathState* paths) {
  const int sequence =
      (int)(scene->header.sampler.kind == SAMPLER_SOBOL ? hash_uint(scene->header.sampler.seed) & ~TILE_PLACE
                                                        : hash_uint(scene->header.sampler.seed));
  for (int i = 0; i < count || i % LANES != 0; i++) {
    set_slot(paths, i, 0);
    set_pixel_hash(paths, i, sequence);
    set_sample_index(paths, i, first + (i < count ? i : count - 1));
    set_depth(paths, i, 0);
  }
}

STAGE void start_photons(const PRIVATE LightSamples* RESTRICT rays, const PRIVATE PathState* paths, int i) {
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const LightSample ray = load_light_sample(rays, j);
      set_ray_origin(&fields, i + j, ray.origin);
      set_ray_direction(&fields, i + j, ray.toward);
      set_ray_tmax(&fields, i + j, ray.tmax);
      set_ray_skip(&fields, i + j, -1);
      set_direction_pdf(&fields, i + j, 1.0f);
      set_throughput(&fields, i + j, ray.radiance);
      set_radiance(&fields, i + j, make_vec3(0.0f, 0.0f, 0.0f));
    }
}

/// The media at the lights. No light reaches a scene from infinity through a medium that has no end.
STAGE void start_photons_in_media(const PRIVATE Scene* scene, const PRIVATE LightSamples* RESTRICT rays,
                                  const PRIVATE PathState* paths, int i) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int light = rays->light[j], kind = scene->lights[light].kind;
      GLOBAL const LightMedia* at = scene->light_media + light;
      MediumStack media;
      media.low = at->low;
      media.high = at->high;
      const bool infinite = is_infinite_light(kind);
      const float tmax = get_ray_tmax(&fields, i + j);
      set_media(&fields, i + j, media);
      set_ray_tmax(&fields, i + j, (infinite & (innermost(media) != 0)) ? -1.0f : tmax);
    }
}

FN void emit_photons(const PRIVATE Scene* scene, int first, int count, float time,
                     const PRIVATE PathState* paths) {
  const PRIVATE SceneHeader* h = &scene->header;
  number_photons(scene, first, count, paths);
  if (NEEDS_MOTION(scene))
    for (int i = 0; i < count || i % LANES != 0; i++) set_time(paths, i, time);
  for (int i = 0; i < count; i += LANES) {
    float u[LANES], v[LANES], s[LANES], t[LANES], fine[LANES], channel[LANES];
    LightSamples rays;
    sample_pair(h->sampler.kind, sequence_length(h), one_point(PAIR_FILM), paths, i, u, v);
    sample_pair(h->sampler.kind, sequence_length(h), one_point(PAIR_EMISSION), paths, i, s, t);
    sample_pair(h->sampler.kind, sequence_length(h), one_point(PAIR_EMITTER), paths, i, fine, channel);
    emit_rays(scene, time, u, v, fine, s, t, &rays);
    start_photons(&rays, paths, i);
    start_chains(paths, i);
    if (NEEDS(scene, TRANSMISSION)) start_media(paths, i);
    if (NEEDS(scene, INSTANCES)) start_outside(paths, i);
    if (NEEDS_MEDIA(scene)) {
      start_in_media(scene, paths, i, channel);
      start_photons_in_media(scene, &rays, paths, i);
    }
  }
}

/// The map that a photon belongs to, or -1.
FN int map_of_photon(const PRIVATE SceneHeader* h, bool in_medium, int chain, int path) {
  const PRIVATE IntegratorParameters* p = &h->integrator;
  const bool caustic = (p->photons == PHOTONS_FIXED) & (chain == CHAIN_SPECULAR);
  if ((p->gathering == GATHER_CAUSTICS) & (chain != CHAIN_SPECULAR)) return -1;
  if (in_medium) return path < p->volume_photons ? PHOTON_MAP_VOLUME : -1;
  if (caustic) return path < p->caustic_photons ? PHOTON_MAP_CAUSTIC : -1;
  return path < p->surface_photons ? PHOTON_MAP_SURFACE : -1;
}

/// The fractions of photons that arrive at these surfaces, for surfaces that let the others pass: the density
/// of those that arrive must not depend on the mask, which paths of the camera take into account.
FN void arriving_shares(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces, PRIVATE float* shares) {
  Surfaces whole = *surfaces;
  PaneTints light;
  float passing[LANES];
  for (int j = 0; j < LANES; j++) {
    const SideMaterials sides = side_materials(scene, surfaces->primitive[j]);
    const int side = surfaces->front[j] ? sides.front : sides.back;
    whole.material[j] = surfaces->primitive[j] >= 0 ? side : 0;
  }
  passing_light(scene, &whole, passing, &light);
  for (int j = 0; j < LANES; j++) {
    const bool masked = surfaces->primitive[j] >= 0;
    const float passed = passing[j];
    shares[j] = (masked & (passed < 1.0f)) ? 1.0f - passed : 1.0f;
  }
}

/// The scattering coefficient of the medium at the point.
FN vec3 scattering_at(const PRIVATE Scene* scene, int index, vec3 p) {
  GLOBAL const Medium* medium = scene->media + index;
  vec3 scattering = mul(load3(&medium->extinction), load3(&medium->albedo));
  if (medium->density >= 0) {
    GLOBAL const Volume* v = scene->volumes + medium->density;
    scattering = mul(scattering, volume_value(scene, v, volume_place(v, p)));
  }
  if (medium->albedo_grid >= 0) {
    GLOBAL const Volume* v = scene->volumes + medium->albedo_grid;
    scattering = mul(scattering, volume_value(scene, v, volume_place(v, p)));
  }
  return scattering;
}

FN vec3 over_positive(vec3 a, vec3 b) {
  return make_vec3(b.x > 0.0f ? a.x / b.x : 0.0f, b.y > 0.0f ? a.y / b.y : 0.0f,
                   b.z > 0.0f ? a.z / b.z : 0.0f);
}

/// Stores the photons of the first `lanes` lanes that have arrived.
FN void store_photons(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int lanes,
                      const PRIVATE StepLanes* step, PhotonStore store) {
  float shares[LANES];
  for (int j = 0; j < LANES; j++) shares[j] = 1.0f;
  if (NEEDS(scene, NESTED)) arriving_shares(scene, &step->surfaces, shares);
  for (int j = 0; j < lanes; j++) {  // no lane loop: photons are scattered
    const Surface s = load_surface(&step->surfaces, j);
    const bool in_medium = s.primitive == IN_MEDIUM;
    const int edges = get_depth(paths, i + j) + 1, path = get_sample_index(paths, i + j);
    const int map = map_of_photon(&scene->header, in_medium, get_chain(paths, i + j), path);
    // A path of the camera may choose another leaf of the material.
    const bool is_leaf = NEEDS(scene, NESTED) && get_material(paths, i + j) >= 0;
    const bool stored =
        is_hit(s) & (edges > 1) & (map >= 0) & (is_leaf | has_diffuse_part(load_closure(&step->closures, j)));
    if (!stored) continue;
    const int index = FETCH_AND_INCREMENT(store.count);
    if ((uint)index >= (uint)store.capacity) continue;
    Photon photon;
    photon.p = s.p;
    photon.wi = s.wo;
    photon.normal = s.geometric;
    photon.power = scale(get_throughput(paths, i + j), 1.0f / shares[j]);
    if (NEEDS_MEDIA(scene) && in_medium)
      photon.power =
          over_positive(photon.power, scattering_at(scene, innermost(get_media(paths, i + j)), s.p));
    photon.map = map;
    photon.path = path;
    photon.edges = edges;
    store.photons[index] = photon;
  }
}

/// For light that goes the other way the weight of a sampled direction has other factors: no square of the
/// refractive index, and other cosines where the shading normal differs from the geometric one (Veach 1997,
/// section 5.3).
FN vec3 photon_weight(Surface s, BsdfSample next, bool bumps) {
  const float in = FABS(dot3(s.shading, s.wo)) * FABS(dot3(s.geometric, next.wi));
  const float out = FABS(dot3(s.geometric, s.wo)) * FABS(dot3(s.shading, next.wi));
  const bool bent = (s.primitive != IN_MEDIUM) & (out > 0.0f);
  const float shadow = bumps ? bump_shadow(s, s.wo) : 1.0f;  // towards the light
  return scale(next.weight, shadow * sqr(next.eta) * (bent ? in / out : 1.0f));
}

/// OpenPBR's surfaces are not reciprocal: light goes from wi to wo by their values for these two. Their
/// samples get the weights that a reciprocal surface of such values would have, but for directions to the
/// other side.
STAGE void weigh_the_other_way(const PRIVATE Closures* RESTRICT closures,
                               const PRIVATE Surfaces* RESTRICT surfaces,
                               const PRIVATE BsdfValues* RESTRICT values,
                               PRIVATE BsdfSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const BsdfSample next = load_bsdf_sample(samples, j);
      const BsdfValue value = load_bsdf_value(values, j);
      const float in = dot3(s.shading, s.wo), out = dot3(s.shading, next.wi);
      const bool known = (in > 0.0f) & (out > 0.0f) & (next.pdf > 0.0f) & (next.pdf != DELTA_PDF);
      const bool turned = known & is_among(load_closure(closures, j), OPENPBRS);
      const float factor = turned ? out / (in * next.pdf) : 0.0f;
      STORE_LANE_vec3(samples->weight, j, select3(turned, scale(value.f_cos, factor), next.weight));
    }
}
FN void weigh_openpbr(const PRIVATE Scene* scene, PRIVATE StepLanes* step) {
  Surfaces seen = step->surfaces;
  float wi[3 * LANES];
  for (int j = 0; j < LANES; j++) {
    STORE_LANE_vec3(seen.wo, j, LOAD_LANE_vec3(step->samples.wi, j));
    STORE_LANE_vec3(wi, j, LOAD_LANE_vec3(step->surfaces.wo, j));
  }
  eval_bsdfs(scene, step->families & OPENPBRS, &step->closures, &seen, wi, &step->values);
  weigh_the_other_way(&step->closures, &step->surfaces, &step->values, &step->samples);
}

/// Scatters the photons of LANES paths, or ends them. Russian roulette keeps the power of photons alike.
STAGE void scatter_photons(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                           const PRIVATE StepLanes* RESTRICT step) {
  const int max_depth = scene->header.integrator.max_depth, rr_depth = scene->header.integrator.rr_depth;
  const bool caustics = scene->header.integrator.gathering == GATHER_CAUSTICS;
  const bool bumps = NEEDS(scene, BENT), coats = NEEDS(scene, COAT_NORMALS);
  const PathState fields = *paths;  // see step.h
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      const BsdfSample next = load_bsdf_sample(&step->samples, j);
      const int depth = get_depth(&fields, i + j) + 1;
      const vec3 weight = photon_weight(s, next, bumps);
      const float strongest = max_component(weight);
      const bool roulette = depth >= rr_depth;
      const float lasts = 1.0f - 2.0f / ((float)(roulette ? depth - rr_depth : 0) + ROULETTE_LASTS);
      const float survival = roulette ? min_f(strongest, lasts) : 1.0f;
      const vec3 power = mul(get_throughput(&fields, i + j), weight);
      const Closure c = load_closure(&step->closures, j);
      const bool diffuse = has_diffuse_part(c) & (next.pdf != DELTA_PDF);
      // Below the base's horizon photon_weight has no meaning.
      const bool beneath = coats & has_open_coat(c) & is_beneath(s, next.wi);
      // One more edge leads to the next arrival, and at least one to the camera.
      const bool alive = is_hit(s) & (depth + 2 <= max_depth) & !(diffuse & caustics) & (next.pdf > 0.0f) &
                         (max_component(power) > 0.0f) & !is_cut_off(scene, s, c, next.wi) & !beneath &
                         (lane_number(step, DIM_ROULETTE, j) < survival);
      set_next_ray(&fields, i + j, s, next, scale(power, 1.0f / (alive ? survival : 1.0f)), alive);
      set_chain(&fields, i + j, next_chain(get_chain(&fields, i + j), diffuse));
    }
}

/// Processes the next arrival of `count` photons.
CALLED_FN void step_photons(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count,
                            int arrivals, PhotonStore store) {
  const PRIVATE SceneHeader* h = &scene->header;
  StepLanes step;
  start_step(&step);
  for (int i = 0; i < count; i += LANES) {
    path_numbers(h, arrivals + 1 >= h->integrator.rr_depth, paths, i, step.u);
    find_surfaces(scene, paths, i, &step.surfaces);
    resolve_step_closures(scene, &step);
    store_photons(scene, paths, i, min_i(LANES, count - i), &step, store);
    if (NEEDS(scene, DISPERSION)) disperse(scene, true, paths, i, &step);
    sample_bsdfs(scene, step.families, &step.closures, &step.surfaces, step.u + DIM_BSDF_U * LANES,
                 step.u + DIM_LOBE_CHOICE * LANES, &step.samples);
    if ((COMPILED_FAMILIES & OPENPBRS) != 0u && (step.families & OPENPBRS) != 0u) weigh_openpbr(scene, &step);
    scatter_photons(scene, paths, i, &step);
    if (NEEDS_MEDIA(scene)) go_on_in_media(paths, i, &step.surfaces);
    if (NEEDS(scene, INSTANCES)) leave_instances(paths, i, &step.surfaces);
  }
}

/// Traces the photon paths `first` ... `first + count - 1` of the task; count is at most the block's
/// capacity.
CALLED_FN void trace_photons(const PRIVATE Scene* of_image, const PRIVATE PhotonTask* task, int first,
                             int count, const PRIVATE Block* block, PhotonStore store) {
  const PRIVATE PathState* paths = &block->paths;
  const Scene of_photons = scene_of_photons(*of_image, task);
  const PRIVATE Scene* scene = &of_photons;
  const uint seed = sequence_seed(of_image->header.sampler.seed, task->sequence);
  const float time = NEEDS_MOTION(scene) ? time_of_map(scene, seed, task->map) : MIDDLE_TIME;
  emit_photons(scene, first, count, time, paths);
  for (int arrivals = 0; count > 0; arrivals++) {
    if (block->traced != 0) block->traced->photon_rays += (ulong)count;
    intersect_block(scene, paths, count, false);
    pad_hits(scene, paths, count);
    if (HAS(NESTED)) see_through(scene, paths, count, arrivals + 1);
#if LANES > 1
    if (NEEDS(scene, MIXED_FAMILIES)) sort_by_family(scene, paths, count);
#endif
    step_photons(scene, paths, count, arrivals, store);
    count = compact(scene, paths, count, NO_CHANNEL, &block->slots);
    if (count > 0) pad_lanes(SCENE_FEATURES(&scene->header), paths, count);
  }
}

PENUMBRA_NAMESPACE_END
#endif
