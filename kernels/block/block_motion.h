// Rays among what moves. A ray first goes through the hierarchy of what moves (motion/motion_bvh.h). Then it
// is traced among what is still, only as far as what it has hit. So the fast ways of tracing, and Embree,
// know nothing of time, and what moves is found in the same way by all of them.
#ifndef PENUMBRA_BLOCK_MOTION_H
#define PENUMBRA_BLOCK_MOTION_H
#include "kernels/block/block_flight.h"
#include "kernels/block/path_state.h"
#include "kernels/motion/motion_bvh.h"

PENUMBRA_NAMESPACE_BEGIN

/// Finds what rays hit of what moves, and ends the rays there.
STAGE void end_rays_at_moving(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i++) {
    const float tmax = get_ray_tmax(paths, i);
    const int skip_instance = NEEDS(scene, INSTANCES) ? get_ray_skip_instance(paths, i) : -1;
    const Hit hit = intersect_moving(scene, get_ray_origin(paths, i), get_ray_direction(paths, i), tmax,
                                     get_ray_skip(paths, i), skip_instance, get_time(paths, i), false);
    set_whole_tmax(paths, i, tmax);
    set_moving_hit(paths, i, hit.primitive);
    set_moving_instance(paths, i, hit.instance);
    if (hit.primitive >= 0) set_ray_tmax(paths, i, hit.t);
  }
}

/// Rays that hit nothing still before that hit what moves.
STAGE void take_moving_hits(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i++) {
    set_ray_tmax(paths, i, get_whole_tmax(paths, i));
    if (get_hit(paths, i) >= 0 || get_moving_hit(paths, i) < 0) continue;
    set_hit(paths, i, get_moving_hit(paths, i));
    if (NEEDS(scene, INSTANCES)) set_hit_instance(paths, i, get_moving_instance(paths, i));
  }
}

/// Shadow rays that reach the light past everything still, and hit what moves.
STAGE void occlude_by_moving(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  for (int i = 0; i < count; i++) {
    const float tmax = get_shadow_tmax(paths, i);
    if (!(tmax > 0.0f) || !(get_shadow_transmittance(paths, i) > 0.0f)) continue;
    const int skip_instance = NEEDS(scene, INSTANCES) ? get_shadow_skip_instance(paths, i) : -1;
    const Hit hit = intersect_moving(scene, get_shadow_origin(paths, i), get_shadow_direction(paths, i), tmax,
                                     get_shadow_skip(paths, i), skip_instance, get_time(paths, i), true);
    if (hit.primitive >= 0) set_transmittance_of_hit(scene, paths, i, hit.primitive);
  }
}

PENUMBRA_NAMESPACE_END
#endif
