// The stages of a block that trace: intersect, occlude, and adding the light of shadow rays that got through.
#ifndef PENUMBRA_BLOCK_TRACE_H
#define PENUMBRA_BLOCK_TRACE_H
#include "kernels/block/path_state.h"
#include "kernels/intersect/bvh.h"
#include "kernels/intersect/intersect_whole.h"

PENUMBRA_NAMESPACE_BEGIN

#if !HAS(BVH)
/// Lane j of the rays: path i's ray in these fields.
FN void load_ray(PRIVATE RayLanes* rays, int j, const GLOBAL float* RESTRICT f,
                 const GLOBAL int* RESTRICT ints, int capacity, int i, int origin, int direction, int tmax,
                 int skip) {
  rays->ox[j] = f[origin * capacity + i];
  rays->oy[j] = f[(origin + 1) * capacity + i];
  rays->oz[j] = f[(origin + 2) * capacity + i];
  rays->dx[j] = f[direction * capacity + i];
  rays->dy[j] = f[(direction + 1) * capacity + i];
  rays->dz[j] = f[(direction + 2) * capacity + i];
  rays->tmax[j] = f[tmax * capacity + i];
  rays->skip[j] = ints[skip * capacity + i];
}

FN void load_rays(PRIVATE RayLanes* rays, const GLOBAL float* RESTRICT f, const GLOBAL int* RESTRICT ints,
                  int capacity, int i) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      load_ray(rays, j, f, ints, capacity, i + j, RAY_ORIGIN_X, RAY_DIRECTION_X, RAY_TMAX, RAY_SKIP);
}

/// Lists the lanes that have a shadow ray, whole LANES of them: the last one again and again.
STAGE int list_shadow_rays(const GLOBAL float* RESTRICT f, int capacity, int count,
                           GLOBAL int* RESTRICT wanted) {
  int n = 0;
  for (int i = 0; i < count; i++) {  // without a branch: which paths have one is not predictable
    wanted[n] = i;
    n += f[SHADOW_TMAX * capacity + i] > 0.0f ? 1 : 0;
  }
  const int last = n > 0 ? wanted[n - 1] : 0;
  for (int i = n; i % LANES != 0; i++) wanted[i] = last;
  return n;
}

FN void gather_shadow_rays(PRIVATE RayLanes* rays, const GLOBAL float* RESTRICT f,
                           const GLOBAL int* RESTRICT ints, int capacity, const GLOBAL int* RESTRICT wanted) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++)
      load_ray(rays, j, f, ints, capacity, wanted[j], SHADOW_ORIGIN_X, SHADOW_DIRECTION_X, SHADOW_TMAX,
               SHADOW_SKIP);
}

FN void scatter_hits(const PRIVATE RayLanes* rays, GLOBAL int* RESTRICT hits,
                     const GLOBAL int* RESTRICT wanted) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) hits[wanted[j]] = rays->hit[j];
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
  for (int i = 0; i < count; i++)
    ints[HIT * capacity + i] =
        intersect_bvh(scene, LOAD3(f, capacity, RAY_ORIGIN_X, i), LOAD3(f, capacity, RAY_DIRECTION_X, i),
                      f[RAY_TMAX * capacity + i], ints[RAY_SKIP * capacity + i])
            .primitive;
#else
  for (int i = 0; i < count; i += LANES) {
    RayLanes rays;
    load_rays(&rays, f, ints, capacity, i);
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
#if HAS(DIRECT)
  if (!scene->header.integrator.trace_shadows) {
    for (int i = 0; i < count; i++) ints[HIT * capacity + i] = -1;
    return;
  }
#endif
#ifdef EXTERNAL_TRACER
  if (scene->tracer.occlude) {
    scene->tracer.occlude(scene->tracer.context, f, ints, capacity, count);
    return;
  }
#endif
#if HAS(BVH)
  for (int i = 0; i < count; i++)
    ints[HIT * capacity + i] =
        occlude_bvh(scene, LOAD3(f, capacity, SHADOW_ORIGIN_X, i), LOAD3(f, capacity, SHADOW_DIRECTION_X, i),
                    f[SHADOW_TMAX * capacity + i], ints[SHADOW_SKIP * capacity + i])
            .primitive;
#else
  GLOBAL int* RESTRICT wanted = ints + GOING * capacity;
  const int rays = list_shadow_rays(f, capacity, count, wanted);
  for (int i = 0; i < rays; i += LANES) {
    RayLanes lanes;
    gather_shadow_rays(&lanes, f, ints, capacity, wanted + i);
    intersect_whole(scene, &lanes);
    scatter_hits(&lanes, ints + HIT * capacity, wanted + i);
  }
#endif
}

/// Adds the light of shadow rays to the field: of all, or with `unblocked` of the unblocked ones. With
/// `control` only of those towards lights with a control variate (`controlled`) or of the others.
STAGE void add_light(int field, bool unblocked, bool control, bool controlled, GLOBAL float* RESTRICT f,
                     const GLOBAL int* RESTRICT ints, int capacity, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const int kind = ints[SHADOW_CONTROLLED * capacity + j];
        const bool wanted = !control | ((kind != CONTROLLED_NOT) == controlled);
        const bool beneath = control & (kind == CONTROLLED_BENEATH);
        const bool through = (!unblocked) | ((ints[HIT * capacity + j] < 0) & !beneath);
        const bool lit = wanted & through & (f[SHADOW_TMAX * capacity + j] > 0.0f);
        const vec3 more = LOAD3(f, capacity, SHADOW_RADIANCE_X, j);
        const vec3 sum = add(LOAD3(f, capacity, field, j), select3(lit, more, make_vec3(0.0f, 0.0f, 0.0f)));
        STORE3(f, capacity, field, j, sum);
      }
  }
}

PENUMBRA_NAMESPACE_END
#endif
