// The block driver: a block of paths goes through generate, then (intersect, step, occlude, compact) until it
// is empty, then accumulate. Each stage is a loop over lanes of constant width. Native code runs a block per
// thread, a CPU OpenCL device a block per work item, a GPU or a debugging session blocks of one path and one
// lane.
#ifndef PENUMBRA_BLOCK_H
#define PENUMBRA_BLOCK_H
#include "kernels/block/block_accumulate.h"
#include "kernels/block/block_compact.h"
#include "kernels/block/block_control.h"
#include "kernels/block/block_look_through.h"
#include "kernels/block/block_step.h"
#include "kernels/block/block_trace.h"
#include "kernels/camera/camera.h"
#include "kernels/sampler/filter.h"

#if (FEATURES) == 0
  #error "FEATURES is 0 or the name of no feature set"
#endif

PENUMBRA_NAMESPACE_BEGIN

/// Paths `first_path` ... of the block's pixels: sample `first_sample + path % sample_count` of pixel `path /
/// sample_count`.
STAGE void generate(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int first_path,
                    int count, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints, int capacity,
                    GLOBAL float* RESTRICT slots, int slot_capacity) {
  const PRIVATE SceneHeader* h = &scene->header;
  const bool halves = in_halves(h);
  int pixel = first_pixel + first_path / unit->sample_count, sample = first_path % unit->sample_count;
  const int pitch = slot_pixels(slot_capacity, unit->sample_count, LANES);
  const int padded = (count + LANES - 1) / LANES * LANES;
  for (int i = 0; i < padded;
       i++) {  // lanes past the count repeat the last path, so that every lane holds valid work
    const int x = unit->x + pixel % unit->width, y = unit->y + pixel / unit->width;
    ints[SLOT * capacity + i] = sample * pitch + (pixel - first_pixel);
    const uint index = unit->first_sample + (uint)sample;
    // Two independent sequences, for an alpha for the samples of each from those of the other.
    const bool second = halves & ((index & 1u) != 0u);
    const uint seed = second ? hash_uint(h->sampler.seed ^ 0x6c078965u) : h->sampler.seed;
    ints[PIXEL_HASH * capacity + i] = (int)pixel_sequence(h->sampler.kind, seed, (uint)x, (uint)y);
    ints[SAMPLE_INDEX * capacity + i] = (int)(halves ? index >> 1 : index);
    ints[FILM_X * capacity + i] = x;
    ints[FILM_Y * capacity + i] = y;
    const bool last = i + 1 >= count, next_pixel = sample + 1 == unit->sample_count;
    pixel += (next_pixel & !last) ? 1 : 0;
    sample = last ? sample : (next_pixel ? 0 : sample + 1);
  }
  const int filter = h->film.filter;
  const float radius = h->film.filter_radius;
  for (int i = 0; i < count; i += LANES) {
    float u[LANES], v[LANES];
    sample_pair(h->sampler.kind, sequence_length(h), one_point(0u), ints, capacity, i, u, v);
    LANE_LOOP
      for (int j = 0; j < LANES; j++) {
        const FilterSample fx = sample_filter(filter, scene->filter_table, u[j]);
        const FilterSample fy = sample_filter(filter, scene->filter_table, v[j]);
        const Ray ray = camera_ray(h, ints[FILM_X * capacity + i + j], ints[FILM_Y * capacity + i + j],
                                   radius * fx.x, radius * fy.x);
        const vec3 one = make_vec3(1.0f, 1.0f, 1.0f), zero = make_vec3(0.0f, 0.0f, 0.0f);
        STORE3(f, capacity, RAY_ORIGIN_X, i + j, ray.origin);
        STORE3(f, capacity, RAY_DIRECTION_X, i + j, ray.direction);
        f[RAY_TMAX * capacity + i + j] = ray.tmax;
        STORE3(f, capacity, THROUGHPUT_X, i + j, one);
        STORE3(f, capacity, RADIANCE_X, i + j, zero);
        f[DIRECTION_PDF * capacity + i + j] = 0.0f;
        ints[RAY_SKIP * capacity + i + j] = -1;
        slots[FILTER_WEIGHT * slot_capacity + ints[SLOT * capacity + i + j]] = fx.weight * fy.weight;
      }
  }
}

#if HAS(POLYGONS)
STAGE void clear_control(GLOBAL float* RESTRICT f, int capacity, int count) {
  const int padded = (count + LANES - 1) / LANES * LANES;
  for (int k = SHADOWED_X; k < STATE_FLOATS; k++)
    for (int i = 0; i < padded; i++) f[k * capacity + i] = 0.0f;
}
#endif

#if HAS(LAYERS)
/// Albedo, normal and depth of what the camera rays hit.
STAGE void record_layers(const PRIVATE Scene* scene, const GLOBAL float* RESTRICT f,
                         const GLOBAL int* RESTRICT ints, int capacity, int count,
                         GLOBAL float* RESTRICT slots, int slot_capacity) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const Surface s = surface_at(scene, ints[HIT * capacity + j], LOAD3(f, capacity, RAY_ORIGIN_X, j),
                                     LOAD3(f, capacity, RAY_DIRECTION_X, j));
        GLOBAL const Material* m = scene->materials + s.material;
        const vec3 zero = make_vec3(0.0f, 0.0f, 0.0f);
  #if HAS(PHONG)
        const vec3 albedo = select3(s.valid, add(load3(&m->diffuse), load3(&m->specular)), zero);
  #else
        const vec3 albedo = select3(s.valid, load3(&m->diffuse), zero);
  #endif
        const vec3 normal = select3(s.valid, s.shading, zero);
        const int slot = ints[SLOT * capacity + j];
        STORE3(slots, slot_capacity, ALBEDO_X, slot, albedo);
        STORE3(slots, slot_capacity, NORMAL_X, slot, normal);
        slots[DEPTH * slot_capacity + slot] = s.valid ? s.distance : 0.0f;
      }
  }
}
#endif

FN bool has_control(const PRIVATE SceneHeader* h) {
#if HAS(POLYGONS)
  return h->integrator.estimator != ESTIMATOR_SAMPLES;
#else
  return false;
#endif
}

/// Traces `path_count` paths, from the `first_path`-th on, of the block's pixels, which start at the unit's
/// `first_pixel`-th: `batch` at a time, at most the capacity. Their samples are then in their slots.
FN void render_paths(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int first_path,
                     int path_count, int batch, const PRIVATE Block* block) {
  GLOBAL float* f = block->f;
  GLOBAL int* ints = block->i;
  GLOBAL float* slots = block->slots;
  const int capacity = block->capacity, slot_capacity = block->slot_capacity;
  const PRIVATE SceneHeader* h = &scene->header;
  const bool camera_rays = h->integrator.kind == INTEGRATOR_DIRECT, control = has_control(h);
#if HAS(LAYERS)
  const bool layers = (h->features & FEATURE_LAYERS) != 0u;
#endif
#if HAS(LOOK_THROUGH)
  const bool look_through = h->integrator.hide_emitters == HIDE_LOOK_THROUGH;
#endif
  bool all_floats = camera_rays;  // CAMERA_RAY_FLOATS too
#if HAS(PROJECTED)
  all_floats = all_floats | uses_projected(scene);
#endif
  for (int done = 0; done < path_count; done += batch) {
    int count = min_i(batch, path_count - done);
    generate(scene, unit, first_pixel, first_path + done, count, f, ints, capacity, slots, slot_capacity);
#if HAS(POLYGONS)
    if (control) clear_control(f, capacity, count);
#endif
    if (block->probe != 0) probe_camera(block);
    for (int step = 0; count > 0; step++) {
      intersect_block(scene, f, ints, capacity, count);
      pad_hits(ints, capacity, count);
#if HAS(LOOK_THROUGH)
      if (look_through && step == 0) look_through_emitters(scene, f, ints, capacity, count);
#endif
#if HAS(LAYERS)
      if (layers && step == 0) record_layers(scene, f, ints, capacity, count, slots, slot_capacity);
#endif
#if HAS(PATH)
      if (h->integrator.kind == INTEGRATOR_PATH) step_paths(scene, f, ints, capacity, count, step);
#endif
#if HAS(DIRECT)
      if (camera_rays && step == 0) keep_camera_rays(f, ints, capacity, count);
      if (camera_rays) step_direct(scene, f, ints, capacity, count, step);
#endif
      if (block->probe != 0) probe_step(block, control, step);
      occlude_block(scene, f, ints, capacity, count);
      add_light(RADIANCE_X, true, control, false, f, ints, capacity, count);
#if HAS(POLYGONS)
      if (control) add_light(UNSHADOWED_X, false, true, true, f, ints, capacity, count);
      if (control) add_light(SHADOWED_X, true, true, true, f, ints, capacity, count);
#endif
      if (block->probe != 0) probe_light(block, step);
      count = compact(f, ints, capacity, count, all_floats, control, slots, slot_capacity);
      if (count > 0) pad_lanes(f, ints, capacity, count, all_floats, control);
    }
  }
}

/// From the samples in the block's slots to the statistics of its pixels, see render_block.
FN void finish_pixels(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int pixels,
                      const PRIVATE Block* block, GLOBAL float* out, GLOBAL BadSamples* bad) {
  const bool layers = (scene->header.features & FEATURE_LAYERS) != 0u;
#if HAS(POLYGONS)
  const bool control = has_control(&scene->header);
  if (control)
    control_samples(scene, unit, first_pixel, pixels, block->slots, block->slot_capacity, layers, out);
  if (control && layers)
    spread_bad_planes(unit, first_pixel, pixels, ANALYTIC_PLANE, WHOLE_PLANE + 1, block->slots,
                      block->slot_capacity, out);
#endif
  if (block->probe != 0) probe_sample(block, SOURCE_CONTROL);
  accumulate(unit, first_pixel, pixels, block->slots, block->slot_capacity, layers, out, bad);
#if HAS(POLYGONS) && HAS(RATIO)
  if (scene->header.integrator.estimator == ESTIMATOR_RATIO)
    accumulate_ratio(unit, first_pixel, pixels, block->slots, block->slot_capacity, layers, out);
#endif
  if (block->probe != 0)
    probe_source(block->probe, bad[BAD_NAN].count + bad[BAD_INFINITE].count == 0u, SOURCE_FILTER, 0);
}

/// Renders `pixels` pixels of the unit, row by row from its `first_pixel`-th, and writes their statistics
/// into the planes of `out` (SampleBufferPlane). `bad`, of BAD_KINDS, notes non-finite samples.
FN void render_block(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int pixels,
                     const PRIVATE Block* block, GLOBAL float* out, GLOBAL BadSamples* bad) {
  render_paths(scene, unit, first_pixel, 0, pixels * unit->sample_count, block->capacity, block);
  finish_pixels(scene, unit, first_pixel, pixels, block, out, bad);
}

PENUMBRA_NAMESPACE_END
#endif
