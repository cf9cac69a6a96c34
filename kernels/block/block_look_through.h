// Hidden emitters that camera rays pass through, as in Mitsuba from 3.7 on: the camera sees what is behind
// them; nothing else about them changes.
#ifndef PENUMBRA_BLOCK_LOOK_THROUGH_H
#define PENUMBRA_BLOCK_LOOK_THROUGH_H
#include "kernels/block/block_surface.h"
#include "kernels/block/block_trace.h"

PENUMBRA_NAMESPACE_BEGIN

#if HAS(LOOK_THROUGH)
  // A ray that has passed through this many emitters sees the next one, unlit.
  #define MAX_LOOKED_THROUGH 4096

/// Keeps the origins and lengths of the camera rays in the fields of the shadow rays, which come later.
STAGE void keep_starts(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        set_shadow_origin(paths, j, get_ray_origin(paths, j));
        set_shadow_tmax(paths, j, get_ray_tmax(paths, j));
      }
  }
}

/// Restores origins and lengths; the hits stay, and their surfaces are the same as without anything in
/// between.
STAGE void restore_starts(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        set_ray_origin(paths, j, get_shadow_origin(paths, j));
        set_ray_tmax(paths, j, get_shadow_tmax(paths, j));
        set_ray_skip(paths, j, -1);
      }
  }
}

/// Restarts a ray that hit an emitter behind it, and marks it as alive.
STAGE void restart_behind(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(surfaces, j);
      const vec3 toward = get_ray_direction(paths, i + j);
      const int skip = get_ray_skip(paths, i + j);
      const float tmax = get_ray_tmax(paths, i + j);
      const bool hidden = s.light >= 0, shorter = hidden & (tmax < NO_LIMIT);
      const vec3 behind = leave_surface(s.p, s.geometric, s.error, toward);
      set_ray_tmax(paths, i + j, shorter ? tmax - s.distance : tmax);
      set_ray_origin(paths, i + j, select3(hidden, behind, s.from));
      set_ray_skip(paths, i + j, hidden ? s.primitive : skip);
      set_alive(paths, i + j, hidden);
    }
}

FN int count_alive(const PRIVATE PathState* paths, int count) {
  int alive = 0;
  for (int i = 0; i < count; i++) alive += get_alive(paths, i) ? 1 : 0;
  return alive;
}

/// From what camera rays hit to what they see.
FN void look_through_emitters(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  keep_starts(paths, count);
  bool any = true;
  for (int k = 0; any && k < MAX_LOOKED_THROUGH; k++) {
    for (int i = 0; i < count; i += LANES) {
      Surfaces surfaces;
      find_surfaces(scene, paths, i, &surfaces);
      restart_behind(paths, i, &surfaces);
    }
    any = count_alive(paths, count) > 0;
    if (any) intersect_block(scene, paths, count);
    if (any) pad_hits(paths, count);
  }
  restore_starts(paths, count);
}
#endif

PENUMBRA_NAMESPACE_END
#endif
