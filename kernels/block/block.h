// The block driver. A block of paths is generated, then repeats (intersect, step, occlude, compact) until it
// is empty, and is then accumulated. Each stage loops over lanes of constant width. Native code runs one
// block per thread, an OpenCL CPU device one block per work item. A GPU uses blocks of one path and one lane.
#ifndef PENUMBRA_BLOCK_H
#define PENUMBRA_BLOCK_H
#include "kernels/block/block_accumulate.h"
#include "kernels/block/block_compact.h"
#include "kernels/block/block_control.h"
#include "kernels/block/block_see_lights.h"
#include "kernels/block/block_see_through.h"
#include "kernels/block/block_sort.h"
#include "kernels/block/block_trace.h"
#include "kernels/camera/camera.h"
#include "kernels/camera/lens_camera.h"
#include "kernels/camera/light_edges.h"
#include "kernels/camera/panorama_camera.h"
#include "kernels/integrator/direct.h"
#include "kernels/integrator/occlusion.h"
#include "kernels/integrator/path.h"
#include "kernels/integrator/whitted.h"
#include "kernels/motion/shutter.h"
#include "kernels/photon/trace_photons.h"
#include "kernels/sampler/filter.h"

PENUMBRA_NAMESPACE_BEGIN

/// The scene with the random sequence and the samples per pixel of this unit, and with its photon maps.
FN Scene scene_of_unit(SceneHeader header, GLOBAL const uint* words, GLOBAL const uint* photons,
                       const PRIVATE Unit* unit) {
  Scene scene = make_scene(header, words);
  PRIVATE SamplerParameters* sampler = &scene.header.sampler;
  sampler->seed = sequence_seed(sampler->seed, unit->sequence);
  if (unit->spp != 0u) sampler->spp = unit->spp;
  scene.photons = photons;
  return scene;
}

/// The random sequence of a pixel's samples of odd index, or of even index. Usually both share one sequence.
/// If alpha for each half of the samples is fitted to the other half (see in_halves), the halves have
/// independent sequences.
FN int sequence_of_pixel(const PRIVATE SceneHeader* h, bool odd, int x, int y) {
  const uint seed = in_halves(h) && odd ? hash_uint(h->sampler.seed ^ 0x6c078965u) : h->sampler.seed;
  return (int)pixel_sequence(h->sampler.kind, seed, (uint)x, (uint)y);
}

/// Numbers paths `first_path` ... of the block's pixels. A path is sample `first_sample + path %
/// sample_count` of pixel `path / sample_count`.
STAGE void number_paths(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int first_path,
                        int count, const PRIVATE PathState* paths, const PRIVATE SlotState* slots) {
  const PRIVATE SceneHeader* h = &scene->header;
  const uint halves = in_halves(h) ? 1u : 0u;
  int pixel = first_pixel + first_path / unit->sample_count, sample = first_path % unit->sample_count;
  const int pitch = slot_pixels(slots->capacity, unit->sample_count, LANES);
  const PathState fields = *paths;  // see step.h
  for (int i = 0; i < count; pixel++, sample = 0) {
    const int x = unit->x + pixel % unit->width, y = unit->y + pixel / unit->width;
    const int even = sequence_of_pixel(h, false, x, y), odd = sequence_of_pixel(h, true, x, y);
    const int samples = min_i(unit->sample_count - sample, count - i);
    const int slot = sample * pitch + (pixel - first_pixel);
    const uint first_index = unit->first_sample + (uint)sample;
    LANE_LOOP
      for (int k = 0; k < samples; k++) {
        const uint index = first_index + (uint)k;
        set_slot(&fields, i + k, slot + k * pitch);
        set_pixel_hash(&fields, i + k, (index & 1u) != 0u ? odd : even);
        set_sample_index(&fields, i + k, (int)(index >> halves));
        set_film_x(&fields, i + k, x);
        set_film_y(&fields, i + k, y);
      }
    i += samples;
  }
  // Lanes past the count repeat the last path, so that every lane holds valid work.
  for (int i = count; i % LANES != 0; i++) {
    set_slot(paths, i, get_slot(paths, count - 1));
    set_pixel_hash(paths, i, get_pixel_hash(paths, count - 1));
    set_sample_index(paths, i, get_sample_index(paths, count - 1));
    set_film_x(paths, i, get_film_x(paths, count - 1));
    set_film_y(paths, i, get_film_y(paths, count - 1));
  }
}

/// Initialises a path with its camera ray.
FN void start_path(const PRIVATE PathState* fields, int i, Ray ray) {
  set_ray_origin(fields, i, ray.origin);
  set_ray_direction(fields, i, ray.direction);
  set_ray_tmax(fields, i, ray.tmax);
  set_ray_skip(fields, i, -1);
  set_direction_pdf(fields, i, 0.0f);
  set_throughput(fields, i, make_vec3(1.0f, 1.0f, 1.0f));
  set_radiance(fields, i, make_vec3(0.0f, 0.0f, 0.0f));
  set_depth(fields, i, 0);
}

// Camera rays of LANES paths through points on the film. FILTER_SAMPLE maps each of u, v to an offset from
// the pixel's centre by the film's filter; `of_lane` is the lane's camera.
#define START_PATHS(stage, FILTER_SAMPLE, of_lane)                                                        \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,                     \
                   const PRIVATE float* RESTRICT u, const PRIVATE float* RESTRICT v,                      \
                   const PRIVATE SlotState* slots) {                                                      \
    const Camera camera = scene->header.camera;                                                           \
    const FilmParameters film = scene->header.film;                                                       \
    const PathState fields = *paths; /* see step.h */                                                     \
    float weights[LANES];                                                                                 \
    LANE_LOOP                                                                                             \
      for (int j = 0; j < LANES; j++) {                                                                   \
        const FilterSample fx = FILTER_SAMPLE(u[j]), fy = FILTER_SAMPLE(v[j]);                            \
        const Ray ray = camera_ray(of_lane, film, get_film_x(&fields, i + j), get_film_y(&fields, i + j), \
                                   film.filter_radius * fx.x, film.filter_radius * fy.x);                 \
        start_path(&fields, i + j, ray);                                                                  \
        weights[j] = fx.weight * fy.weight;                                                               \
      }                                                                                                   \
    for (int j = 0; j < LANES; j++) set_slot_filter_weight(slots, get_slot(paths, i + j), weights[j]);    \
  }
#define PLAIN_SAMPLE(u) sample_plain_filter(film.filter, u)
#define TABULATED_SAMPLE(u) sample_filter(film.filter, scene->filter_table, u)
#define MOVED_CAMERA camera_at(scene, camera, get_time(&fields, i + j))
START_PATHS(start_paths, PLAIN_SAMPLE, camera)
START_PATHS(start_tabulated_paths, TABULATED_SAMPLE, camera)
START_PATHS(start_moving_paths, TABULATED_SAMPLE, MOVED_CAMERA)
#undef TABULATED_SAMPLE
#undef PLAIN_SAMPLE
#undef START_PATHS

FN void start_pinhole_paths(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,
                            const PRIVATE float* u, const PRIVATE float* v, const PRIVATE SlotState* slots) {
  if (HAS(MOTION) && camera_moves(scene))
    start_moving_paths(scene, paths, i, u, v, slots);
  else if (scene->header.film.filter == FILTER_TABULATED)
    start_tabulated_paths(scene, paths, i, u, v, slots);
  else
    start_paths(scene, paths, i, u, v, slots);
}

/// Numbers for points on the lens.
FN void sample_lens(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, PRIVATE float* u,
                    PRIVATE float* v) {
  const PRIVATE SceneHeader* h = &scene->header;
  if (h->camera.lens_radius > 0.0f) {
    sample_pair(h->sampler.kind, sequence_length(h), one_point(PAIR_LENS), paths, i, u, v);
    return;
  }
  for (int j = 0; j < LANES; j++) u[j] = v[j] = 0.5f;
}

// The same with a lens, see lens_camera.h.
#define START_LENS_PATHS(stage, of_lane)                                                                  \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int channel,        \
                   const PRIVATE float* RESTRICT u, const PRIVATE float* RESTRICT v,                      \
                   const PRIVATE SlotState* slots) {                                                      \
    const PRIVATE SceneHeader* h = &scene->header;                                                        \
    const Camera camera = h->camera;                                                                      \
    const FilmParameters film = h->film;                                                                  \
    const float image_scale = channel_of(h->camera.image_scale, channel);                                 \
    const PathState fields = *paths; /* see step.h */                                                     \
    float weights[LANES], x[LANES], y[LANES], lens_u[LANES], lens_v[LANES];                               \
    float lens_x[LANES], lens_y[LANES], distances[LANES];                                                 \
    sample_lens(scene, paths, i, lens_u, lens_v);                                                         \
    LANE_LOOP                                                                                             \
      for (int j = 0; j < LANES; j++) {                                                                   \
        const FilterSample fx = sample_filter(film.filter, scene->filter_table, u[j]);                    \
        const FilterSample fy = sample_filter(film.filter, scene->filter_table, v[j]);                    \
        const FilmPoint p =                                                                               \
            film_point(camera, film, image_scale, get_film_x(&fields, i + j), get_film_y(&fields, i + j), \
                       film.filter_radius * fx.x, film.filter_radius * fy.x);                             \
        x[j] = p.x;                                                                                       \
        y[j] = p.y;                                                                                       \
        weights[j] = fx.weight * fy.weight;                                                               \
        distances[j] = film_radius(of_lane, p.x, p.y);                                                    \
      }                                                                                                   \
    if (camera.reach > 0.0f) undistort(camera, distances, x, y);                                          \
    LANE_LOOP                                                                                             \
      for (int j = 0; j < LANES; j++) {                                                                   \
        const LensPoint lens = lens_point(camera, lens_u[j], lens_v[j]);                                  \
        lens_x[j] = lens.x;                                                                               \
        lens_y[j] = lens.y;                                                                               \
      }                                                                                                   \
    LANE_LOOP                                                                                             \
      for (int j = 0; j < LANES; j++) {                                                                   \
        const Camera own = of_lane;                                                                       \
        start_path(&fields, i + j,                                                                        \
                   lens_ray(own, channel_of(own.focus, channel), x[j], y[j], lens_x[j], lens_y[j]));      \
      }                                                                                                   \
    for (int j = 0; j < LANES; j++) set_slot_filter_weight(slots, get_slot(paths, i + j), weights[j]);    \
  }
START_LENS_PATHS(start_lens_paths, camera)
START_LENS_PATHS(start_moving_lens_paths, MOVED_CAMERA)
#undef START_LENS_PATHS

// The same with a panoramic camera, see panorama_camera.h. No lane loop: the projections differ.
#define START_PANORAMA_PATHS(stage, of_lane)                                                                 \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int channel,           \
                   const PRIVATE float* RESTRICT u, const PRIVATE float* RESTRICT v,                         \
                   const PRIVATE SlotState* slots) {                                                         \
    const PRIVATE SceneHeader* h = &scene->header;                                                           \
    const Camera camera = h->camera;                                                                         \
    const FilmParameters film = h->film;                                                                     \
    const PathState fields = *paths; /* see step.h */                                                        \
    float lens_u[LANES], lens_v[LANES];                                                                      \
    sample_lens(scene, paths, i, lens_u, lens_v);                                                            \
    for (int j = 0; j < LANES; j++) {                                                                        \
      const FilterSample fx = sample_filter(film.filter, scene->filter_table, u[j]);                         \
      const FilterSample fy = sample_filter(film.filter, scene->filter_table, v[j]);                         \
      const int x = get_film_x(&fields, i + j), y = get_film_y(&fields, i + j);                              \
      const PanoramaView view = panorama_view(                                                               \
          camera, panorama_point(camera, film, x, y, film.filter_radius * fx.x, film.filter_radius * fy.x)); \
      const Camera own = of_lane;                                                                            \
      Ray ray = panorama_ray(own, channel_of(own.focus, channel), view.direction, eye_of_row(own, film, y),  \
                             lens_point(camera, lens_u[j], lens_v[j]));                                      \
      /* What no picture shows is black: its samples hit nothing and weigh nothing. */                       \
      ray.tmax = view.seen ? ray.tmax : 0.0f;                                                                \
      start_path(&fields, i + j, ray);                                                                       \
      set_slot_filter_weight(slots, get_slot(paths, i + j), view.seen ? fx.weight* fy.weight : 0.0f);        \
    }                                                                                                        \
  }
START_PANORAMA_PATHS(start_panorama_paths, camera)
START_PANORAMA_PATHS(start_moving_panorama_paths, MOVED_CAMERA)
#undef MOVED_CAMERA
#undef START_PANORAMA_PATHS

STAGE void clear_control(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) {
      const vec3 zero = make_vec3(0.0f, 0.0f, 0.0f);
      set_shadowed(paths, j, zero);
      set_unshadowed(paths, j, zero);
      set_analytic(paths, j, zero);
    }
}

/// For integrators that do not note it.
STAGE void clear_direct(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_direct(paths, j, make_vec3(0.0f, 0.0f, 0.0f));
}

CALLED_FN void generate(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int first_path,
                        int count, int channel, const PRIVATE PathState* paths,
                        const PRIVATE SlotState* slots) {
  const PRIVATE SceneHeader* h = &scene->header;
  number_paths(scene, unit, first_pixel, first_path, count, paths, slots);
  for (int i = 0; i < count; i += LANES) {
    float u[LANES], v[LANES];
    sample_pair(h->sampler.kind, sequence_length(h), one_point(PAIR_FILM), paths, i, u, v);
    if (NEEDS_MOTION(scene)) set_sample_times(scene, unit->first_sample, paths, i);
    const bool moves = camera_moves(scene);
    const bool panorama = NEEDS_PANORAMA(scene), lens = NEEDS(scene, CAMERA) && !panorama;
    if (panorama && !moves) start_panorama_paths(scene, paths, i, channel, u, v, slots);
    if (panorama && moves) start_moving_panorama_paths(scene, paths, i, channel, u, v, slots);
    if (lens && !moves) start_lens_paths(scene, paths, i, channel, u, v, slots);
    if (lens && moves) start_moving_lens_paths(scene, paths, i, channel, u, v, slots);
    if (!panorama && !lens) start_pinhole_paths(scene, paths, i, u, v, slots);
    if (NEEDS_LIGHT_EDGES(scene)) add_light_edges(scene, paths, i, u, v);
    if (NEEDS(scene, POLYGONS)) clear_control(paths, i);
    if (NEEDS_SPLIT_LIGHT(scene)) clear_direct(paths, i);
    if (NEEDS(scene, TRANSMISSION)) start_media(paths, i);
    if (NEEDS_PHOTONS(scene)) start_chains(paths, i);
    if (NEEDS(scene, FLAT_GLASS)) start_without_glass(paths, i);
    if (NEEDS(scene, INSTANCES)) start_outside(paths, i);
    if (NEEDS_MEDIA(scene)) {
      sample_pair(h->sampler.kind, sequence_length(h), one_point(PAIR_CHANNEL), paths, i, u, v);
      start_in_media(scene, paths, i, u);
      if (NEEDS_INTERIORS(scene)) start_outside_interiors(paths, i);
    }
  }
}

/// Whether the integrator evaluates BSDFs at the hits of a step.
FN bool hits_scatter(const PRIVATE SceneHeader* h, int step) {
  const int kind = h->integrator.kind;
  return (kind == INTEGRATOR_PATH) | (kind == INTEGRATOR_WHITTED) |
         ((kind == INTEGRATOR_DIRECT) & (step == 0));
}

/// Traces `path_count` paths of the block's pixels, from the `first_path`-th on, and writes their samples to
/// their slots. The pixels start at the unit's `first_pixel`-th. `batch` paths are traced at a time, at most
/// the capacity. If the camera has a different image for each channel, each path is traced once per channel
/// with the same random numbers, and its sample takes only that channel. Layers come from green.
FN void render_paths(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int first_path,
                     int path_count, int batch, const PRIVATE Block* block) {
  const PRIVATE PathState* paths = &block->paths;
  const PRIVATE SlotState* slots = &block->slots;
  const PRIVATE SceneHeader* h = &scene->header;
  const bool control = has_control(scene);
  const int channels = HAS(CAMERA) ? camera_channels(h) : 1;
  const int turns = channels * ((path_count + batch - 1) / batch);
  for (int turn = 0; turn < turns; turn++) {
    const int done = turn / channels * batch, channel = (turn + FIRST_CHANNEL) % channels;
    int count = min_i(batch, path_count - done);
    generate(scene, unit, first_pixel, first_path + done, count, channel, paths, slots);
    if (block->probe != 0) probe_camera(block);
    for (int step = 0; count > 0; step++) {
      intersect_block(scene, paths, count, step == 0);
      pad_hits(scene, paths, count);
      if (HAS(NESTED) || HAS(LOOK_THROUGH)) see_through(scene, paths, count, step);
#if LANES > 1
      if (NEEDS(scene, MIXED_FAMILIES) && hits_scatter(h, step)) sort_by_family(scene, paths, count);
#endif
      if (HAS(PATH) && h->integrator.kind == INTEGRATOR_PATH) step_paths(scene, paths, count, step, slots);
      if (HAS(DIRECT) && h->integrator.kind == INTEGRATOR_DIRECT)
        step_direct(scene, paths, count, step, slots);
      if (HAS(WHITTED) && h->integrator.kind == INTEGRATOR_WHITTED)
        step_whitted(scene, paths, count, step, slots);
      if (HAS(OCCLUSION) && h->integrator.kind == INTEGRATOR_OCCLUSION)
        step_occlusion(scene, paths, count, step, slots);
      if (block->probe != 0) probe_step(block, control, step);
      if (block->traced != 0) count_rays(paths, count, block->traced);
      occlude_block(scene, paths, count);
      if (NEEDS_PASSING_LIGHT(scene)) see_lights_through(scene, paths, count);
      if (NEEDS(scene, BENT) && h->integrator.kind != INTEGRATOR_OCCLUSION) shade_shadow_rays(paths, count);
      if (HAS(POLYGONS) && control) add_light_with_control(scene, has_lobe_control(scene), paths, count);
      if (!control) add_light(paths, count);
      if (block->probe != 0) probe_light(block, step);
      count = compact(scene, paths, count, channels == 1 ? EVERY_CHANNEL : channel, slots);
      if (count > 0) pad_lanes(SCENE_FEATURES(h), paths, count);
    }
  }
}

/// Computes the statistics of the block's pixels from the samples in its slots, see render_block.
CALLED_FN void finish_pixels(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel,
                             int pixels, const PRIVATE Block* block, GLOBAL float* out,
                             GLOBAL BadSamples* bad) {
  const ulong features = SCENE_FEATURES(&scene->header);
  const PRIVATE SlotState* slots = &block->slots;
  if (HAS(POLYGONS) && has_control(scene)) {
    control_samples(scene, unit, first_pixel, pixels, slots, features, out);
    if (has_layer(features, LAYER_ANALYTIC))
      spread_bad_planes(unit, first_pixel, pixels, layer_plane(features, LAYER_ANALYTIC),
                        layer_plane(features, LAYER_UNSHADOWED) + 1, slots, out);
  }
  if (block->probe != 0) probe_sample(block, SOURCE_CONTROL);
  accumulate(unit, first_pixel, pixels, slots, features, out, bad);
  if (NEEDS(scene, DENOISING)) {
    const bool shares = scene->header.integrator.photons == PHOTONS_PROGRESSIVE;
    const int shared = shares ? scene->header.integrator.samples_per_map : 1;
    accumulate_halves(unit, first_pixel, pixels, slots, features, (uint)max_i(shared, 1), out);
  }
  if (NEEDS_MEDIA(scene)) note_contradictions(unit, first_pixel, pixels, slots, bad);
  if (NEEDS(scene, MATTES)) accumulate_mattes(unit, first_pixel, pixels, slots, features, out);
  if (block->probe != 0)
    probe_source(block->probe, bad[BAD_NAN].count + bad[BAD_INFINITE].count == 0u, SOURCE_FILTER, 0);
}

/// Renders `pixels` pixels of the unit, row by row from its `first_pixel`-th, and writes their statistics
/// into the planes of `out` (SampleBufferPlane). `bad` has BAD_KINDS entries, which count bad samples.
CALLED_FN void render_block(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int pixels,
                            const PRIVATE Block* block, GLOBAL float* out, GLOBAL BadSamples* bad) {
  render_paths(scene, unit, first_pixel, 0, pixels * unit->sample_count, block->paths.capacity, block);
  finish_pixels(scene, unit, first_pixel, pixels, block, out, bad);
}

PENUMBRA_NAMESPACE_END
#endif
