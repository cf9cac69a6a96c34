// The instances on which rays start and those that they hit. Paths store them beside primitives, only in
// scenes with instances.
#ifndef PENUMBRA_BLOCK_INSTANCES_H
#define PENUMBRA_BLOCK_INSTANCES_H
#include "kernels/block/path_state.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Camera rays do not start on an instance.
STAGE void start_outside(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) set_ray_skip_instance(paths, j, -1);
}

/// For scenes whose primitives are all tested: these have no instances, whatever their header says.
STAGE void clear_hit_instances(const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i += LANES) {
    LANE_LOOP
      for (int j = i; j < i + LANES; j++) set_hit_instance(paths, j, -1);
  }
}

/// The next rays of LANES paths and their shadow rays start on the instances of these surfaces.
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

/// Keeps the surfaces' instances in step 0, loads them in later steps. The rays of the step start there.
FN void keep_at_instances(const PRIVATE PathState* paths, int i, int k, PRIVATE Surfaces* surfaces) {
  if (k == 0) keep_instances(paths, i, surfaces);
  if (k > 0) load_kept_instances(paths, i, surfaces);
  leave_instances(paths, i, surfaces);
}

// Instances of rays that pass through surfaces. Each function is called before, and belongs to, the function
// of block_see_through.h or block_see_lights.h with a similar name.

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

/// `ray_skip_instance` is not restored for rays that return to their original origin: the next step does not
/// read it.
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
