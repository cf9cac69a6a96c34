// Hidden emitters that camera rays pass through, as in Mitsuba from 3.7 on: the camera sees what is behind
// them; nothing else about them changes.
#ifndef PENUMBRA_BLOCK_LOOK_THROUGH_H
#define PENUMBRA_BLOCK_LOOK_THROUGH_H
#include "kernels/block/block_trace.h"
#include "kernels/intersect/surface.h"

PENUMBRA_NAMESPACE_BEGIN

#if HAS(LOOK_THROUGH)
  // A ray that has passed through this many emitters sees the next one, unlit.
  #define MAX_LOOKED_THROUGH 4096

/// Keeps the origins and lengths of the camera rays in the fields of the shadow rays, which come later.
STAGE void keep_starts(GLOBAL float* RESTRICT f, int capacity, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const vec3 origin = LOAD3(f, capacity, RAY_ORIGIN_X, j);
        STORE3(f, capacity, SHADOW_ORIGIN_X, j, origin);
        f[SHADOW_TMAX * capacity + j] = f[RAY_TMAX * capacity + j];
      }
  }
}

/// Restores origins and lengths; the hits stay, and surface_at() is the same as without anything in between.
STAGE void restore_starts(GLOBAL float* RESTRICT f, GLOBAL int* RESTRICT ints, int capacity, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const vec3 origin = LOAD3(f, capacity, SHADOW_ORIGIN_X, j);
        STORE3(f, capacity, RAY_ORIGIN_X, j, origin);
        f[RAY_TMAX * capacity + j] = f[SHADOW_TMAX * capacity + j];
        ints[RAY_SKIP * capacity + j] = -1;
      }
  }
}

/// Restarts the rays that hit an emitter behind it, and marks them in ALIVE.
STAGE void start_behind_emitters(const PRIVATE Scene* scene, GLOBAL float* RESTRICT f,
                                 GLOBAL int* RESTRICT ints, int capacity, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const vec3 from = LOAD3(f, capacity, RAY_ORIGIN_X, j),
                   toward = LOAD3(f, capacity, RAY_DIRECTION_X, j);
        const int primitive = ints[HIT * capacity + j], skip = ints[RAY_SKIP * capacity + j];
        const Surface s = surface_at(scene, primitive, from, toward);
        const bool hidden = s.light >= 0;
        const vec3 origin = select3(hidden, leave_surface(s.p, s.geometric, s.error, toward), from);
        const float tmax = f[RAY_TMAX * capacity + j];
        const bool shorter = hidden & (tmax < NO_LIMIT);
        f[RAY_TMAX * capacity + j] = shorter ? tmax - s.distance : tmax;
        STORE3(f, capacity, RAY_ORIGIN_X, j, origin);
        ints[RAY_SKIP * capacity + j] = hidden ? primitive : skip;
        ints[ALIVE * capacity + j] = hidden ? 1 : 0;
      }
  }
}

FN int count_alive(const GLOBAL int* ints, int capacity, int count) {
  int alive = 0;
  for (int i = 0; i < count; i++) alive += ints[ALIVE * capacity + i];
  return alive;
}

/// From what camera rays hit to what they see.
FN void look_through_emitters(const PRIVATE Scene* scene, GLOBAL float* f, GLOBAL int* ints, int capacity,
                              int count) {
  keep_starts(f, capacity, count);
  bool any = true;
  for (int k = 0; any && k < MAX_LOOKED_THROUGH; k++) {
    start_behind_emitters(scene, f, ints, capacity, count);
    any = count_alive(ints, capacity, count) > 0;
    if (any) intersect_block(scene, f, ints, capacity, count);
    if (any) pad_hits(ints, capacity, count);
  }
  restore_starts(f, ints, capacity, count);
}
#endif

PENUMBRA_NAMESPACE_END
#endif
