// The block driver: a block of paths goes through generate, then (intersect, step, occlude, compact) until it
// is empty, then accumulate. Each stage is a loop over lanes of constant width. Native code runs a block per
// thread, a CPU OpenCL device a block per work item, a GPU or a debugging session blocks of one path and one
// lane.
#ifndef PENUMBRA_BLOCK_H
#define PENUMBRA_BLOCK_H
#include "kernels/bvh.h"
#include "kernels/camera.h"
#include "kernels/filter.h"
#include "kernels/integrator_direct.h"
#include "kernels/integrator_path.h"
#include "kernels/intersect_whole.h"
#include "kernels/unit.h"

#if (FEATURES) == 0
  #error "FEATURES is 0 or the name of no feature set"
#endif

PENUMBRA_NAMESPACE_BEGIN

/// Paths `first` ... of the block's pixels: sample `first_sample + slot % sample_count` of pixel `slot /
/// sample_count`.
STAGE void generate(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int first_slot,
                    int count, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints, int capacity,
                    GLOBAL float* RESTRICT slots, int slot_capacity) {
  const PRIVATE SceneHeader* h = &scene->header;
  int pixel = first_pixel + first_slot / unit->sample_count, sample = first_slot % unit->sample_count;
  const int padded = (count + LANES - 1) / LANES * LANES;
  for (int i = 0; i < padded;
       i++) {  // lanes past the count repeat the last path, so that every lane holds valid work
    const int x = unit->x + pixel % unit->width, y = unit->y + pixel / unit->width;
    ints[SLOT * capacity + i] = first_slot + min_i(i, count - 1);
    ints[PIXEL_HASH * capacity + i] = (int)pixel_hash(h->seed, (uint)x, (uint)y);
    ints[SAMPLE_INDEX * capacity + i] = (int)(unit->first_sample + (uint)sample);
    ints[FILM_X * capacity + i] = x;
    ints[FILM_Y * capacity + i] = y;
    const bool last = i + 1 >= count, next_pixel = sample + 1 == unit->sample_count;
    pixel += (next_pixel & !last) ? 1 : 0;
    sample = last ? sample : (next_pixel ? 0 : sample + 1);
  }
  const int filter = h->filter;
  const float radius = h->filter_radius;
  for (int i = 0; i < count; i += LANES) {
    float u[LANES], v[LANES];
    draw_pair(h->sampler, h->spp, 0u, ints, capacity, i, u, v);
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

#if !HAS(BVH)
FN void load_rays(PRIVATE RayLanes* rays, const GLOBAL float* RESTRICT f, const GLOBAL int* RESTRICT ints,
                  int capacity, int i, int origin, int direction, int tmax, int skip) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      rays->ox[j] = f[origin * capacity + i + j];
      rays->oy[j] = f[(origin + 1) * capacity + i + j];
      rays->oz[j] = f[(origin + 2) * capacity + i + j];
      rays->dx[j] = f[direction * capacity + i + j];
      rays->dy[j] = f[(direction + 1) * capacity + i + j];
      rays->dz[j] = f[(direction + 2) * capacity + i + j];
      rays->tmax[j] = f[tmax * capacity + i + j];
      rays->skip[j] = ints[skip * capacity + i + j];
    }
}
#endif

STAGE void intersect_block(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                           int capacity, int count) {
#ifdef EXTERNAL_TRACER
  if (scene->tracer.intersect) {
    scene->tracer.intersect(scene->tracer.context, f, ints, capacity, count);
    return;
  }
#endif
#if HAS(BVH)
  for (int i = 0; i < count; i++) {
    const Hit hit =
        intersect_bvh(scene, LOAD3(f, capacity, RAY_ORIGIN_X, i), LOAD3(f, capacity, RAY_DIRECTION_X, i),
                      f[RAY_TMAX * capacity + i], ints[RAY_SKIP * capacity + i], false);
    ints[HIT * capacity + i] = hit.primitive;
  }
#else
  for (int i = 0; i < count; i += LANES) {
    RayLanes rays;
    load_rays(&rays, f, ints, capacity, i, RAY_ORIGIN_X, RAY_DIRECTION_X, RAY_TMAX, RAY_SKIP);
    intersect_whole(scene, &rays);
    LANE_LOOP
      for (int j = 0; j < LANES; j++) ints[HIT * capacity + i + j] = rays.hit[j];
  }
#endif
}

/// Intersectors that take one ray at a time leave lanes from `count` on alone: they repeat the last path's
/// hit too.
FN void pad_hits(GLOBAL int* ints, int capacity, int count) {
  for (int i = count; i % LANES != 0; i++) ints[HIT * capacity + i] = ints[HIT * capacity + count - 1];
}

/// Leaves in HIT of each lane whether its shadow ray is blocked (>= 0) or free (-1).
STAGE void occlude_block(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                         int capacity, int count) {
#ifdef EXTERNAL_TRACER
  if (scene->tracer.occlude) {
    scene->tracer.occlude(scene->tracer.context, f, ints, capacity, count);
    return;
  }
#endif
#if HAS(BVH)
  for (int i = 0; i < count; i++) {
    const Hit hit = intersect_bvh(scene, LOAD3(f, capacity, SHADOW_ORIGIN_X, i),
                                  LOAD3(f, capacity, SHADOW_DIRECTION_X, i), f[SHADOW_TMAX * capacity + i],
                                  ints[SHADOW_SKIP * capacity + i], true);
    ints[HIT * capacity + i] = hit.primitive;
  }
#else
  for (int i = 0; i < count; i += LANES) {
    RayLanes rays;
    load_rays(&rays, f, ints, capacity, i, SHADOW_ORIGIN_X, SHADOW_DIRECTION_X, SHADOW_TMAX, SHADOW_SKIP);
    float longest = -1.0f;
    for (int j = 0; j < LANES; j++) longest = max_f(longest, rays.tmax[j]);
    if (longest <= 0.0f) continue;
    intersect_whole(scene, &rays);
    LANE_LOOP
      for (int j = 0; j < LANES; j++) ints[HIT * capacity + i + j] = rays.hit[j];
  }
#endif
}

STAGE void add_unoccluded(GLOBAL float* RESTRICT f, const GLOBAL int* RESTRICT ints, int capacity,
                          int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const bool lit = (f[SHADOW_TMAX * capacity + j] > 0.0f) & (ints[HIT * capacity + j] < 0);
        const vec3 more = LOAD3(f, capacity, SHADOW_RADIANCE_X, j);
        const vec3 radiance =
            add(LOAD3(f, capacity, RADIANCE_X, j), select3(lit, more, make_vec3(0.0f, 0.0f, 0.0f)));
        STORE3(f, capacity, RADIANCE_X, j, radiance);
      }
  }
}

/// The first three pairs of a step's numbers, for LANES paths from lane i on.
FN void draw_step(const PRIVATE SceneHeader* h, uint pair, const GLOBAL int* RESTRICT ints, int capacity,
                  int i, PRIVATE float* RESTRICT u) {
  draw_pair(h->sampler, h->spp, pair, ints, capacity, i, u + DRAW_LIGHT_U * LANES, u + DRAW_LIGHT_V * LANES);
  draw_pair(h->sampler, h->spp, pair + 1u, ints, capacity, i, u + DRAW_BSDF_U * LANES,
            u + DRAW_BSDF_V * LANES);
  draw_pair(h->sampler, h->spp, pair + 2u, ints, capacity, i, u + DRAW_LIGHT_CHOICE * LANES,
            u + DRAW_LOBE_CHOICE * LANES);
}

#if HAS(PATH)
  #if HAS(PROJECTED)
/// The aims of LANES paths from lane i on.
STAGE void aim_path_lanes(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f,
                          const GLOBAL int* RESTRICT ints, int capacity, int i,
                          const PRIVATE float* RESTRICT u, PRIVATE float* RESTRICT aims) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) aim_path(scene, f, ints, capacity, i + j, u, j, aims);
}
  #endif

STAGE void step_paths(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                      int capacity, int count, int step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const uint pair = step_pair(step);
  const bool roulette = step + 1 >= h->rr_depth;
  #if HAS(PROJECTED)
  const bool aimed = wants_aims(scene);
  #endif
  for (int i = 0; i < count; i += LANES) {
    float u[DRAWS * LANES];
    draw_step(h, pair, ints, capacity, i, u);
    for (int j = 0; j < LANES; j++) u[DRAW_ROULETTE * LANES + j] = 0.0f;
    if (roulette) {
      draw_pair(h->sampler, h->spp, pair + 3u, ints, capacity, i, u + DRAW_ROULETTE * LANES,
                u + DRAW_SPARE * LANES);
    }
    float aims[AIM_FLOATS];
  #if HAS(PROJECTED)
    if (aimed)
      aim_path_lanes(scene, f, ints, capacity, i, u, aims);
    else
      for (int j = 0; j < LANES; j++) store_no_aim(aims, j);
  #endif
    LANE_LOOP
      for (int j = 0; j < LANES; j++) path_step(scene, f, ints, capacity, step, i + j, u, j, aims);
  }
}
#endif

#if HAS(DIRECT)
STAGE void keep_camera_rays(GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints, int capacity, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) keep_camera_ray(f, ints, capacity, j);
  }
}

  #if HAS(PROJECTED)
/// The aims of LANES paths from lane i on.
STAGE void aim_direct_lanes(const PRIVATE Scene* scene, const GLOBAL float* RESTRICT f,
                            const GLOBAL int* RESTRICT ints, int capacity, int i,
                            const PRIVATE float* RESTRICT u, PRIVATE float* RESTRICT aims) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) aim_direct(scene, f, ints, capacity, i + j, u, j, aims);
}
  #endif

STAGE void step_direct(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints,
                       int capacity, int count, int step) {
  const PRIVATE SceneHeader* h = &scene->header;
  const uint pair = step_pair(step);
  #if HAS(PROJECTED)
  const bool aimed = wants_aims(scene);
  #endif
  for (int i = 0; i < count; i += LANES) {
    float u[DRAWS * LANES];
    draw_step(h, pair, ints, capacity, i, u);
    float aims[AIM_FLOATS];
  #if HAS(PROJECTED)
    if (aimed)
      aim_direct_lanes(scene, f, ints, capacity, i, u, aims);
    else
      for (int j = 0; j < LANES; j++) store_no_aim(aims, j);
  #endif
    LANE_LOOP
      for (int j = 0; j < LANES; j++) direct_step(scene, f, ints, capacity, step, i + j, u, j, aims);
  }
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

/// Finished paths leave their radiance in their slot; the others move up, in order. Returns how many are
/// left.
STAGE int compact(GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints, int capacity, int count,
                  bool all_floats, GLOBAL float* RESTRICT slots, int slot_capacity) {
  GLOBAL int* RESTRICT going = ints + GOING * capacity;
  GLOBAL int* RESTRICT finished = ints + FINISHED * capacity;
  int left = 0, gone = 0;
  for (int i = 0; i < count; i++) {  // without a branch: which paths end is not predictable
    const int alive = ints[ALIVE * capacity + i];
    going[left] = i;
    finished[gone] = i;
    left += alive;
    gone += 1 - alive;
  }
  for (int m = 0; m < gone; m++) {
    const int i = finished[m];
    const int slot = ints[SLOT * capacity + i];
    const vec3 radiance = LOAD3(f, capacity, RADIANCE_X, i);
    STORE3(slots, slot_capacity, SAMPLE_X, slot, radiance);
  }
  // A field at a time. In place, since going[m] >= m.
  const int floats = all_floats ? PATH_AND_CAMERA_RAY_COUNT : PATH_FLOAT_COUNT;
  for (int k = 0; gone > 0 && k < floats; k++) {
    GLOBAL float* field = f + k * capacity;
    LANE_LOOP
      for (int m = 0; m < left; m++) field[m] = field[going[m]];
  }
  for (int k = 0; gone > 0 && k < PATH_INT_COUNT; k++) {
    GLOBAL int* field = ints + k * capacity;
    LANE_LOOP
      for (int m = 0; m < left; m++) field[m] = field[going[m]];
  }
  return left;
}

/// Lanes from `count` to the next multiple of LANES repeat the last path, so that every lane holds valid
/// work.
FN void pad_lanes(GLOBAL float* f, GLOBAL int* ints, int capacity, int count, bool all_floats) {
  const int floats = all_floats ? PATH_AND_CAMERA_RAY_COUNT : PATH_FLOAT_COUNT;
  for (int i = count; i % LANES != 0; i++) {
    for (int k = 0; k < floats; k++) f[k * capacity + i] = f[k * capacity + count - 1];
    for (int k = 0; k < PATH_INT_COUNT; k++) ints[k * capacity + i] = ints[k * capacity + count - 1];
  }
}

FN bool is_nan_bits(uint bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }
FN bool is_infinite_bits(uint bits) { return (bits & 0x7fffffffu) == 0x7f800000u; }

/// Mean of a slot field over a pixel's samples, by the deviations from a first estimate, which leaves no
/// rounding of the sum behind; also the sum of squared deviations.
FN void accumulate_field(const GLOBAL float* RESTRICT values, int first, int count, PRIVATE float* mean,
                         PRIVATE float* m2) {
  float sum = 0.0f;
  for (int s = 0; s < count; s++) sum += values[first + s];
  const float estimate = sum / (float)count;
  float deviation = 0.0f, squares = 0.0f;
  for (int s = 0; s < count; s++) {
    const float d = values[first + s] - estimate;
    deviation += d;
    squares += d * d;
  }
  *mean = estimate + deviation / (float)count;
  *m2 = max_f(squares - deviation * (deviation / (float)count), 0.0f);
}

/// Statistics of the block's pixels, in sample order. Samples with a NaN or an infinity count as 0 and are
/// counted.
STAGE void accumulate(const PRIVATE Unit* unit, int first_pixel, int pixels, GLOBAL float* RESTRICT slots,
                      int slot_capacity, bool layers, GLOBAL float* RESTRICT out, GLOBAL uint* RESTRICT bad) {
  const int n = unit->sample_count, area = unit->width * unit->height;
  uint nans = 0u, infinities = 0u;
  for (int s = 0; s < pixels * n; s++) {
    const float weight = slots[FILTER_WEIGHT * slot_capacity + s];
    const vec3 sample = scale(LOAD3(slots, slot_capacity, SAMPLE_X, s), weight);
    const uint x = FLOAT_BITS(sample.x), y = FLOAT_BITS(sample.y), z = FLOAT_BITS(sample.z);
    const bool nan = is_nan_bits(x) | is_nan_bits(y) | is_nan_bits(z);
    const bool infinite = (is_infinite_bits(x) | is_infinite_bits(y) | is_infinite_bits(z)) & !nan;
    const vec3 kept = select3(nan | infinite, make_vec3(0.0f, 0.0f, 0.0f), sample);
    STORE3(slots, slot_capacity, SAMPLE_X, s, kept);
    nans += nan ? 1u : 0u;
    infinities += infinite ? 1u : 0u;
#if HAS(LAYERS)
    for (int k = ALBEDO_X; layers && k <= DEPTH; k++) slots[k * slot_capacity + s] *= weight;
#endif
  }
  for (int p = 0; p < pixels; p++) {
    const int at = first_pixel + p;
    for (int k = 0; k < 3; k++) {
      float mean, m2;
      accumulate_field(slots + (SAMPLE_X + k) * slot_capacity, p * n, n, &mean, &m2);
      out[k * area + at] = mean;
      out[(3 + k) * area + at] = m2;
    }
#if HAS(LAYERS)
    for (int k = 0; layers && k < DEPTH - ALBEDO_X + 1; k++) {
      float mean, m2;
      accumulate_field(slots + (ALBEDO_X + k) * slot_capacity, p * n, n, &mean, &m2);
      out[(6 + k) * area + at] = mean;
    }
#endif
  }
  bad[0] += nans;
  bad[1] += infinities;
}

/// Renders `pixels` pixels of the unit, row by row from its `first_pixel`-th, and writes their statistics
/// into the planes of `out` (SampleBufferPlane). `bad` counts samples with NaN and with infinity.
FN void render_block(const PRIVATE Scene* scene, const PRIVATE Unit* unit, int first_pixel, int pixels,
                     const PRIVATE Block* block, GLOBAL float* out, GLOBAL uint* bad) {
  GLOBAL float* f = block->f;
  GLOBAL int* ints = block->i;
  GLOBAL float* slots = block->slots;
  const int capacity = block->capacity, slot_capacity = block->slot_capacity;
  const int total = pixels * unit->sample_count;
  const bool camera_rays = scene->header.integrator == INTEGRATOR_DIRECT;
  const bool layers = (scene->header.features & FEATURE_LAYERS) != 0u;
  bool all_floats = camera_rays;  // CAMERA_RAY_FLOATS too
#if HAS(PROJECTED)
  all_floats = all_floats | wants_aims(scene);
#endif
  for (int first = 0; first < total; first += capacity) {
    int count = min_i(capacity, total - first);
    generate(scene, unit, first_pixel, first, count, f, ints, capacity, slots, slot_capacity);
    for (int step = 0; count > 0; step++) {
      intersect_block(scene, f, ints, capacity, count);
      pad_hits(ints, capacity, count);
#if HAS(LAYERS)
      if (layers && step == 0) record_layers(scene, f, ints, capacity, count, slots, slot_capacity);
#endif
#if HAS(PATH)
      if (scene->header.integrator == INTEGRATOR_PATH) step_paths(scene, f, ints, capacity, count, step);
#endif
#if HAS(DIRECT)
      if (camera_rays && step == 0) keep_camera_rays(f, ints, capacity, count);
      if (camera_rays) step_direct(scene, f, ints, capacity, count, step);
#endif
      occlude_block(scene, f, ints, capacity, count);
      add_unoccluded(f, ints, capacity, count);
      count = compact(f, ints, capacity, count, all_floats, slots, slot_capacity);
      if (count > 0) pad_lanes(f, ints, capacity, count, all_floats);
    }
  }
  accumulate(unit, first_pixel, pixels, slots, slot_capacity, layers, out, bad);
}

PENUMBRA_NAMESPACE_END
#endif
