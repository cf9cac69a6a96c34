// Media along rays: where paths scatter before they meet a surface, and how media attenuate paths and shadow
// rays. The stages that follow rays through surfaces (block_see_through.h, block_see_lights.h) call these
// functions from surface to surface.
#ifndef PENUMBRA_BLOCK_MEDIA_H
#define PENUMBRA_BLOCK_MEDIA_H
#include "kernels/block/block_boundaries.h"
#include "kernels/intersect/surface.h"
#include "kernels/light/light_sample.h"
#include "kernels/light/mis.h"
#include "kernels/medium/equiangular.h"
#include "kernels/medium/medium_state.h"
#include "kernels/medium/tracking.h"
#include "kernels/sampler/sampler.h"

PENUMBRA_NAMESPACE_BEGIN

/// Camera rays start in the camera's medium. `choice`, in [0, 1), selects the channel that samples distances
/// (hero).
STAGE void start_in_media(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          const PRIVATE float* RESTRICT choice) {
  const MediumStack camera = {(uint)scene->header.camera_medium, 0u};
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      set_media(&fields, i + j, camera);
      set_contradiction(&fields, i + j, 0);
      set_boundary(&fields, i + j, no_boundary());
      set_hero(&fields, i + j, min_i((int)(choice[j] * 3.0f), 2));
      set_channels(&fields, i + j, make_vec3(1.0f, 1.0f, 1.0f));
    }
}

/// Camera rays do not start in interiors of materials.
STAGE void start_outside_interiors(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) {
      set_inner(paths, j, 0);
      set_inner_albedo(paths, j, make_vec3(1.0f, 1.0f, 1.0f));
    }
}

/// A hash of the path's sample and depth for random numbers of one purpose (`salt`).
FN uint step_hash(const PRIVATE PathState* paths, int i, uint salt) {
  return hash_uint((uint)get_sample_index(paths, i) + hash_uint((uint)get_depth(paths, i) + salt));
}

/// Initialises flights before the rays' hits are used. `u`, in [0, 1), chooses the optical depths at which
/// they scatter.
STAGE void start_flights(const PRIVATE PathState* paths, int i, const PRIVATE float* RESTRICT u) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const uint digits =
          hash_uint((uint)get_pixel_hash(&fields, i + j) ^ step_hash(&fields, i + j, 0x51ed270bu));
      set_depth_left(&fields, i + j, flight_depth(u[j], unit_float(digits)));
      set_beyond(&fields, i + j, get_media(&fields, i + j));
      set_way(&fields, i + j, 0.0f);
      set_crossed(&fields, i + j, 0);
      // Rays in a medium go on even if they meet no surface.
      const bool flies = innermost(get_media(&fields, i + j)) != 0;
      const float tmax = get_ray_tmax(&fields, i + j), kept = get_kept_tmax(&fields, i + j);
      set_ray_tmax(&fields, i + j, flies ? kept : tmax);
    }
}

/// Stores the pdfs of the rays' directions, which flights change.
STAGE void note_left_pdfs(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_left_pdf(paths, j, get_direction_pdf(paths, j));
}

/// Whether any ray under way is in a medium, met a boundary, or crossed one (the boundary may coincide with
/// the surface where it arrives).
FN bool any_in_media(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i) {
  int any = 0;
  for (int j = i; j < i + LANES; j++) {
    const bool in_medium = innermost(get_media(paths, j)) != 0;
    const bool meets = boundary_of(scene, get_hit(paths, j)) >= 0;
    const bool crossed = get_crossed(paths, j) != 0;
    any |= ((get_ray_tmax(paths, j) > 0.0f) & (in_medium | meets | crossed)) ? 1 : 0;
  }
  return any != 0;
}

/// The distances from the last boundary, or from the ray's start, to these surfaces; without a surface, to
/// the ray's end.
STAGE void flight_lengths(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces,
                          PRIVATE float* RESTRICT lengths) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const float tmax = get_kept_tmax(&fields, i + j), way = get_way(&fields, i + j);
      const float to =
          flight_to(&fields, i + j, get_media(&fields, i + j), s, get_kept_origin(&fields, i + j));
      lengths[j] = s.primitive >= 0 ? to : max_f(tmax < NO_LIMIT ? tmax - way : NO_LIMIT, 0.0f);
    }
}

/// Whether any medium is heterogeneous.
FN bool has_grids(const PRIVATE Scene* scene) { return scene->header.tables.volumes.count > 0; }

/// The random state of one ray from distance `way` on.
FN uint ray_state(const PRIVATE PathState* paths, int i, float way, uint salt) {
  return hash_uint((uint)get_pixel_hash(paths, i) ^ hash_uint(step_hash(paths, i, salt) ^ FLOAT_BITS(way)));
}

/// A random number in [0, 1) of one ray, for choices inside the medium in which it scatters.
FN float ray_number(const PRIVATE PathState* paths, int i, uint salt) {
  return unit_float(ray_state(paths, i, 0.0f, salt));
}

/// For LANES rays, the light cluster about which each may sample its distance.
STAGE void choose_equiangular_lights(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                     PRIVATE int* RESTRICT chosen) {
  const int centres = scene->header.tables.flight_centres.count;
  float numbers[LANES];
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      numbers[j] = ray_number(paths, i + j, 0x1f83d9abu);
      chosen[j] = 0;
    }
  for (int k = 0; k + 1 < centres; k++) {
    const float below = scene->flight_centres[k].below;
    LANE_LOOP
      for (int j = 0; j < LANES; j++) chosen[j] += numbers[j] >= below ? 1 : 0;
  }
}

/// The equiangular segments of the rays about these clusters. Returns whether any ray is in a homogeneous
/// medium for which the cluster matters.
STAGE bool find_equiangular_segments(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                                     const PRIVATE float* RESTRICT lengths,
                                     const PRIVATE int* RESTRICT chosen,
                                     PRIVATE EquiangularSegments* RESTRICT segments) {
  int any = 0;
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      GLOBAL const Medium* medium = scene->media + innermost(get_media(&fields, i + j));
      GLOBAL const FlightCentre* centre = scene->flight_centres + chosen[j];
      const vec3 direction = get_ray_direction(&fields, i + j);
      const vec3 origin = add_scaled(get_kept_origin(&fields, i + j), get_way(&fields, i + j), direction);
      const float length = lengths[j];
      const EquiangularSegment segment =
          equiangular_segment(origin, direction, length, load3(&centre->place), centre->size);
      const vec3 shares = equiangular_shares(segment, length, load3(&medium->extinction));
      const bool under_way = get_ray_tmax(&fields, i + j) > 0.0f;
      const bool lit = !is_grid(medium) & (medium->interior == 0) & !only_absorbs(load3(&medium->albedo));
      any |= (under_way & lit & (max_component(shares) > 0.0f)) ? 1 : 0;
      store_equiangular(segments, j, segment);
    }
  return any != 0;
}

/// For flights in homogeneous media that scatter before the surfaces: samples their distances, by the
/// transmittance or equiangularly about a light cluster, into `reaches`, weights the flights and sets
/// `decided`.
STAGE void aim_flights(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                       const PRIVATE float* RESTRICT lengths,
                       const PRIVATE EquiangularSegments* RESTRICT segments, PRIVATE float* RESTRICT reaches,
                       PRIVATE int* RESTRICT decided) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      GLOBAL const Medium* medium = scene->media + innermost(get_media(&fields, i + j));
      const vec3 extinction = load3(&medium->extinction), albedo = load3(&medium->albedo);
      const float left = get_depth_left(&fields, i + j), length = lengths[j];
      const int hero = get_hero(&fields, i + j);
      const float sigma = channel_of(extinction, hero);
      const bool lit = !is_grid(medium) & (medium->interior == 0) & !only_absorbs(albedo);
      const bool scatters =
          (get_ray_tmax(&fields, i + j) > 0.0f) & lit & (sigma > 0.0f) & (left < sigma * length);
      const EquiangularSegment segment = load_equiangular(segments, j);
      const vec3 shares = equiangular_shares(segment, length, extinction);
      const float number = ray_number(&fields, i + j, 0x5be0cd19u);
      const bool equiangular = number < channel_of(shares, hero);
      // Among flights that scatter, the number that chose the optical depth is uniform.
      const float u = expm1_f(-left) / min_f(expm1_f(-sigma * length), -1e-37f);
      const float reach = equiangular ? min_f(equiangular_distance(segment, min_f(u, 1.0f)), length)
                                      : left / max_f(sigma, 1e-30f);
      const FlightWeight before = flight_weight(&fields, i + j);
      const FlightWeight after =
          weigh_equiangular(before, extinction, albedo, segment, shares, length, reach);
      const bool decides = scatters & (max_component(shares) > 0.0f) & (segment.angle > 0.0f);
      set_flight_weight(&fields, i + j, select_flight_weight(decides, after, before));
      reaches[j] = decides ? reach : reaches[j];
      decided[j] = decides ? 1 : decided[j];
    }
}

/// The same, if the scene has light clusters.
FN void sample_equiangular(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                           const PRIVATE float* lengths, PRIVATE float* reaches, PRIVATE int* decided) {
  if (scene->header.tables.flight_centres.count == 0) return;
  int chosen[LANES];
  EquiangularSegments segments;
  choose_equiangular_lights(scene, paths, i, chosen);
  if (find_equiangular_segments(scene, paths, i, lengths, chosen, &segments))
    aim_flights(scene, paths, i, lengths, &segments, reaches, decided);
}

/// For flights of rays under way in heterogeneous media, up to the surfaces: sets `reaches` to where they
/// scatter (negative: nowhere), weights the flights and sets `decided`.
FN void fly_through_grids(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          const PRIVATE float* lengths, PRIVATE float* reaches, PRIVATE int* decided) {
  for (int j = 0; j < LANES; j++) {  // no lane loop: the number of tracking steps differs
    GLOBAL const Medium* medium = scene->media + innermost(get_media(paths, i + j));
    if (!(get_ray_tmax(paths, i + j) > 0.0f) || !is_grid(medium)) continue;
    const float way = get_way(paths, i + j);
    const vec3 direction = get_ray_direction(paths, i + j),
               start = add_scaled(get_kept_origin(paths, i + j), way, direction);
    const TrackedFlight flight = track_flight(
        scene, medium, start, direction, lengths[j], get_hero(paths, i + j), flight_weight(paths, i + j),
        get_depth_left(paths, i + j), ray_state(paths, i + j, way, 0x3c6ef372u));
    set_flight_weight(paths, i + j, flight.weight);
    if (!is_finite3(flight.weight.throughput)) set_radiance(paths, i + j, flight.weight.throughput);
    set_depth_left(paths, i + j, flight.left);
    reaches[j] = flight.reach;
    decided[j] = 1;
  }
}

/// Flights of rays under way in media, up to the surfaces. A flight that ends before its surface scatters
/// there and has arrived.
///
/// `reaches`: on entry the distances, from the last boundary, of flights that are decided; on return those of
/// all flights; negative: no scattering.
STAGE void fly(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
               const PRIVATE int* RESTRICT primitives, const PRIVATE float* RESTRICT lengths,
               const PRIVATE int* RESTRICT decided, PRIVATE float* RESTRICT reaches) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float tmax = get_ray_tmax(&fields, i + j), left = get_depth_left(&fields, i + j);
      const float length = lengths[j];
      const int index = innermost(get_media(&fields, i + j));
      GLOBAL const Medium* medium = scene->media + index;
      const vec3 extinction = load3(&medium->extinction), albedo = load3(&medium->albedo);
      const int leaf = get_material(&fields, i + j), phase = medium->material;
      const float sigma = only_absorbs(albedo) ? 0.0f : channel_of(extinction, get_hero(&fields, i + j));
      const bool is_decided = decided[j] != 0;
      const float reach = is_decided ? reaches[j] : left / max_f(sigma, 1e-30f);
      const bool flies = (tmax > 0.0f) & (max_component(extinction) > 0.0f) & !is_decided;
      const bool scatters = is_decided ? reach >= 0.0f : flies & (sigma > 0.0f) & (reach < length);
      const FlightWeight before = flight_weight(&fields, i + j);
      const FlightWeight after =
          weigh_homogeneous(before, extinction, albedo, scatters ? reach : length, scatters);
      set_flight_weight(&fields, i + j, select_flight_weight(flies, after, before));
      set_depth_left(&fields, i + j, flies ? left - sigma * length : left);
      reaches[j] = scatters ? reach : -1.0f;
      set_material(&fields, i + j, scatters ? phase : leaf);
      const int kept = get_kept_hit(&fields, i + j);
      set_kept_hit(&fields, i + j, scatters ? IN_MEDIUM : kept);
      const bool arrives = scatters | (primitives[j] < 0);
      set_ray_tmax(&fields, i + j, arrives ? -1.0f : tmax);
    }
}

/// Multiplies throughputs by the albedo of heterogeneous media in which paths scatter.
FN void apply_grid_albedo(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                          const PRIVATE float* reaches) {
  for (int j = 0; j < LANES; j++) {  // no lane loop, as above
    const int index = scene->media[innermost(get_media(paths, i + j))].albedo_grid;
    if (!(reaches[j] >= 0.0f) || index < 0) continue;
    GLOBAL const Volume* v = scene->volumes + index;
    const vec3 albedo = volume_value(scene, v, volume_place(v, get_ray_origin(paths, i + j)));
    set_throughput(paths, i + j, mul(get_throughput(paths, i + j), albedo));
  }
}

/// Likewise by the paths' own albedos, of media whose albedo follows the colour of a surface.
STAGE void apply_inner_albedo(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                              const PRIVATE float* RESTRICT reaches) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int curve = scene->media[innermost(get_media(&fields, i + j))].albedo_curve;
      const vec3 before = get_throughput(&fields, i + j), albedo = get_inner_albedo(&fields, i + j);
      const bool scatters = (reaches[j] >= 0.0f) & (curve >= 0);
      set_throughput(&fields, i + j, select3(scatters, mul(before, albedo), before));
    }
}

/// Initialises the media of shadow rays: nothing attenuates them yet. `shadow_densities` are the densities
/// with which the channels of a path would have passed: those of media that only absorb are 1.
STAGE void start_shadow_flights(const PRIVATE PathState* paths, int count) {
  const PathState fields = *paths;
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        set_shadow_passes(&fields, j, make_vec3(1.0f, 1.0f, 1.0f));
        set_shadow_densities(&fields, j, make_vec3(1.0f, 1.0f, 1.0f));
        set_way(&fields, j, 0.0f);
        set_crossed(&fields, j, 0);
      }
  }
}

/// Distance to the light itself; shadow rays end slightly before it.
FN float shadow_length(const PRIVATE PathState* paths, int i) {
  const float tmax = get_shadow_tmax(paths, i);
  return tmax < NO_LIMIT ? tmax * (1.0f / SHADOW_RAY_END) : NO_LIMIT;
}

/// Transmittance of a homogeneous medium over `length`. 1 in heterogeneous media, which dim_in_grids handles.
FN vec3 passes_homogeneous(const PRIVATE Scene* scene, MediumStack media, float length) {
  GLOBAL const Medium* medium = scene->media + innermost(media);
  return exp3(scale(load3(&medium->extinction), is_grid(medium) ? 0.0f : -length));
}

/// Whether paths pass through the medium with density 1.
FN bool passes_surely(const PRIVATE Scene* scene, MediumStack media) {
  return only_absorbs(load3(&scene->media[innermost(media)].albedo));
}

/// Multiplies `shadow_passes` of LANES shadow rays by the transmittance of heterogeneous media, over
/// `lengths` from `ways` on. Rays of length 0 are skipped.
FN void dim_in_grids(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                     const PRIVATE float* ways, const PRIVATE float* lengths) {
  for (int j = 0; j < LANES; j++) {  // no lane loop, as in fly_through_grids
    GLOBAL const Medium* medium = scene->media + innermost(get_shadow_media(paths, i + j));
    if (!(lengths[j] > 0.0f) || !is_grid(medium)) continue;
    const vec3 direction = get_shadow_direction(paths, i + j);
    const vec3 start = add_scaled(get_shadow_origin(paths, i + j), ways[j], direction);
    const vec3 passes = track_passing(scene, medium, start, direction, lengths[j],
                                      ray_state(paths, i + j, ways[j], 0xa54ff53au));
    set_shadow_passes(paths, i + j, mul(get_shadow_passes(paths, i + j), passes));
    if (!only_absorbs(load3(&medium->albedo)))
      set_shadow_densities(paths, i + j, mul(get_shadow_densities(paths, i + j), passes));
  }
}

/// Transmittance of media along unoccluded shadow rays.
STAGE void dim_unobstructed(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  const PathState fields = *paths;
  float ways[LANES], lengths[LANES];
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        const bool seen =
            (get_shadow_tmax(&fields, i + j) > 0.0f) & (get_shadow_transmittance(&fields, i + j) >= 1.0f);
        ways[j] = 0.0f;
        lengths[j] = seen ? shadow_length(&fields, i + j) : 0.0f;
        const MediumStack media = get_shadow_media(&fields, i + j);
        const vec3 passes = passes_homogeneous(scene, media, lengths[j]);
        const bool dims = seen & !passes_surely(scene, media);
        set_shadow_passes(&fields, i + j, select3(seen, passes, get_shadow_passes(&fields, i + j)));
        set_shadow_densities(&fields, i + j, select3(dims, passes, get_shadow_densities(&fields, i + j)));
      }
    if (has_grids(scene)) dim_in_grids(scene, paths, i, ways, lengths);
  }
}

/// Transmittance of media up to the next surface, or up to the light for rays that met no further surface.
STAGE void dim_flights(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                       const PRIVATE Surfaces* RESTRICT surfaces, PRIVATE float* RESTRICT lengths) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const bool under_way = get_ray_tmax(&fields, i + j) > 0.0f;
      const float whole = shadow_length(&fields, i + j), way = get_way(&fields, i + j);
      const MediumStack media = get_shadow_media(&fields, i + j);
      const Surface s = load_surface(surfaces, j);
      const float to = flight_to(&fields, i + j, media, s, get_shadow_origin(&fields, i + j));
      const float length = s.primitive >= 0 ? to : max_f(whole < NO_LIMIT ? whole - way : NO_LIMIT, 0.0f);
      lengths[j] = length;
      const vec3 passes = passes_homogeneous(scene, media, under_way ? length : 0.0f);
      const vec3 before = get_shadow_densities(&fields, i + j);
      set_shadow_passes(&fields, i + j, mul(get_shadow_passes(&fields, i + j), passes));
      set_shadow_densities(&fields, i + j, select3(passes_surely(scene, media), before, mul(before, passes)));
    }
  if (!has_grids(scene)) return;
  float ways[LANES], under_way[LANES];
  for (int j = 0; j < LANES; j++) {
    ways[j] = get_way(paths, i + j);
    under_way[j] = get_ray_tmax(paths, i + j) > 0.0f ? lengths[j] : 0.0f;
  }
  dim_in_grids(scene, paths, i, ways, under_way);
}

/// Shadow rays to points of a medium bring light only if they arrive in that medium.
STAGE void end_in_glows(const PRIVATE PathState* paths, int count) {
  const PathState fields = *paths;
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const int glow = get_shadow_glow(&fields, j);
        const bool arrives = (glow < 0) | (innermost(get_shadow_media(&fields, j)) == glow);
        const vec3 passes = get_shadow_passes(&fields, j);
        set_shadow_passes(&fields, j, select3(arrives, passes, make_vec3(0.0f, 0.0f, 0.0f)));
      }
  }
}

/// Combines, for shadow rays, the transmittance of media and the MIS weight against direction sampling. A
/// path that sampled the light's direction would have reached the light with a density proportional to the
/// mean of its channels' `shadow_densities`. Panes are part of neither density.
STAGE void weigh_shadow_rays(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  const int heuristic = scene->header.integrator.heuristic;
  const PathState fields = *paths;
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const vec3 passes = get_shadow_passes(&fields, j);
        const vec3 densities = mul(get_channels(&fields, j), get_shadow_densities(&fields, j));
        const float found = get_shadow_balance(&fields, j) * mean3(densities);
        set_shadow_passes(&fields, j, scale(passes, mis_weight(heuristic, 1.0f, found)));
      }
  }
}

PENUMBRA_NAMESPACE_END
#endif
