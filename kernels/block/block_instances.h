// What paths keep of instances beside what they keep of primitives: the instances on which rays start and
// those that they hit. Scenes with instances alone.
#ifndef PENUMBRA_BLOCK_INSTANCES_H
#define PENUMBRA_BLOCK_INSTANCES_H
#include "kernels/block/path_state.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Camera rays start nowhere.
STAGE void start_outside(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_ray_skip_instance(paths, j, -1);
}

/// Of scenes that are tested whole, which have none whatever their header says.
STAGE void clear_hit_instances(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) set_hit_instance(paths, j, -1);
  }
}

/// The next rays of LANES paths, and their shadow rays, start on these surfaces.
STAGE void leave_instances(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int instance = surfaces->instance[j];
      set_ray_skip_instance(&fields, i + j, instance);
      set_shadow_skip_instance(&fields, i + j, instance);
    }
}

STAGE void keep_instances(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) set_surface_instance(paths, i + j, surfaces->instance[j]);
}
STAGE void load_kept_instances(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) surfaces->instance[j] = get_surface_instance(paths, i + j);
}

/// The rays of step k start on the surfaces that were kept, or are now.
FN void keep_at_instances(const PRIVATE PathState* paths, int i, int k, PRIVATE Surfaces* surfaces) {
  if (k == 0) keep_instances(paths, i, surfaces);
  if (k > 0) load_kept_instances(paths, i, surfaces);
  leave_instances(paths, i, surfaces);
}

// Rays that pass through surfaces: each of these before, and beside, the function of block_see_through.h that
// it is named after.

STAGE void keep_start_instances(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) set_kept_hit_instance(paths, j, get_hit_instance(paths, j));
  }
}

STAGE void restart_behind_instances(const PRIVATE PathState* paths, int i,
                                    const PRIVATE Surfaces* RESTRICT surfaces,
                                    const PRIVATE int* RESTRICT passes) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const int skip = get_ray_skip_instance(&fields, i + j), hit = get_hit_instance(&fields, i + j);
      const int kept = get_kept_hit_instance(&fields, i + j);
      const bool under_way = get_ray_tmax(&fields, i + j) > 0.0f, through = passes[j] != 0;
      set_ray_skip_instance(&fields, i + j, through ? surfaces->instance[j] : skip);
      set_kept_hit_instance(&fields, i + j, under_way ? hit : kept);
    }
}

STAGE void arrive_at_instances(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) {
      const int hit = get_hit_instance(paths, j), kept = get_kept_hit_instance(paths, j);
      set_kept_hit_instance(paths, j, get_ray_tmax(paths, j) > 0.0f ? hit : kept);
    }
}

/// Those whose ways end at their own origin start where they did before any step: a step does not need to
/// know.
STAGE void end_ways_at_instances(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        const int hit = get_hit_instance(paths, j), kept = get_kept_hit_instance(paths, j);
        set_hit_instance(paths, j, get_ray_tmax(paths, j) > 0.0f ? hit : kept);
      }
  }
}

STAGE void follow_from_instances(const PRIVATE PathState* paths, int count) {
  const PathState fields = *paths;
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        set_kept_skip_instance(&fields, j, get_ray_skip_instance(&fields, j));
        set_kept_hit_instance(&fields, j, get_hit_instance(&fields, j));
        set_ray_skip_instance(&fields, j, get_shadow_skip_instance(&fields, j));
      }
  }
}

STAGE void leave_for_instances(const PRIVATE PathState* paths, int count) {
  const PathState fields = *paths;
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) {
        set_ray_skip_instance(&fields, j, get_kept_skip_instance(&fields, j));
        set_hit_instance(&fields, j, get_kept_hit_instance(&fields, j));
      }
  }
}

PENUMBRA_NAMESPACE_END
#endif
