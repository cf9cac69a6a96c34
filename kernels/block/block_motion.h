// Rays among what moves. A ray first goes through the hierarchy of what moves (motion/motion_bvh.h). Then it
// is traced among what is still, only as far as what it has hit. So the fast ways of tracing, and Embree,
// know nothing of time, and what moves is found in the same way by all of them.
#ifndef PENUMBRA_BLOCK_MOTION_H
#define PENUMBRA_BLOCK_MOTION_H
#include "kernels/block/block_flight.h"
#include "kernels/block/path_state.h"
#include "kernels/motion/motion_bvh.h"

PENUMBRA_NAMESPACE_BEGIN

/// Whether a ray from `o`, where `in` is 1 / its direction, enters child k of a node before `end` at a time.
/// As enter_moving_children.
FN bool enters_moving_child(GLOBAL const MotionNode* node, int k, float time, vec3 o, vec3 in, float end) {
  const vec3 low = make_vec3(node->low[0][k] + time * node->low_speed[0][k],
                             node->low[1][k] + time * node->low_speed[1][k],
                             node->low[2][k] + time * node->low_speed[2][k]);
  const vec3 high = make_vec3(node->high[0][k] + time * node->high_speed[0][k],
                              node->high[1][k] + time * node->high_speed[1][k],
                              node->high[2][k] + time * node->high_speed[2][k]);
  const vec3 out = scale(in, SLAB_MARGIN);
  const float near_x = in.x < 0.0f ? high.x : low.x, far_x = in.x < 0.0f ? low.x : high.x;
  const float near_y = in.y < 0.0f ? high.y : low.y, far_y = in.y < 0.0f ? low.y : high.y;
  const float near_z = in.z < 0.0f ? high.z : low.z, far_z = in.z < 0.0f ? low.z : high.z;
  const float t0 =
      max_f(max_f((near_x - o.x) * in.x, (near_y - o.y) * in.y), max_f((near_z - o.z) * in.z, 0.0f));
  const float t1 =
      min_f(min_f((far_x - o.x) * out.x, (far_y - o.y) * out.y), min_f((far_z - o.z) * out.z, end));
  return (t0 <= t1) & (time >= node->begin[k]) & (time <= node->end[k]);
}

// Sets enters[j] to whether the ray of path i + j enters any child of the root of what moves: most rays of
// most scenes miss what moves.
#define ENTER_MOVING(stage, ray)                                                                         \
  STAGE void stage(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i,                    \
                   PRIVATE int* RESTRICT enters) {                                                       \
    GLOBAL const MotionNode* root = scene->motion_nodes;                                                 \
    const PathState fields = *paths; /* see step.h */                                                    \
    float inverse[3 * LANES];                                                                            \
    LANE_LOOP                                                                                            \
      for (int j = 0; j < LANES; j++) {                                                                  \
        const vec3 d = get_##ray##_direction(&fields, i + j);                                            \
        STORE_LANE_vec3(inverse, j, make_vec3(1.0f / d.x, 1.0f / d.y, 1.0f / d.z));                      \
        enters[j] = 0;                                                                                   \
      }                                                                                                  \
    for (int k = 0; k < BVH_WIDTH; k++) {                                                                \
      if (root->begin[k] > root->end[k]) continue; /* an empty slot */                                   \
      LANE_LOOP                                                                                          \
        for (int j = 0; j < LANES; j++) {                                                                \
          const float tmax = get_##ray##_tmax(&fields, i + j);                                           \
          const bool enters_child =                                                                      \
              enters_moving_child(root, k, get_time(&fields, i + j), get_##ray##_origin(&fields, i + j), \
                                  LOAD_LANE_vec3(inverse, j), tmax * END_MARGIN);                        \
          enters[j] |= (enters_child & (tmax > 0.0f)) ? 1 : 0;                                           \
        }                                                                                                \
    }                                                                                                    \
  }
ENTER_MOVING(enter_moving, ray)
ENTER_MOVING(enter_moving_by_shadow_rays, shadow)
#undef ENTER_MOVING

STAGE void clear_moving_hits(const PRIVATE PathState* paths, int i) {
  const PathState fields = *paths;
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) {
      set_whole_tmax(&fields, j, get_ray_tmax(&fields, j));
      set_moving_hit(&fields, j, -1);
      set_moving_instance(&fields, j, -1);
    }
}

/// Finds what rays hit of what moves, and ends the rays there.
STAGE void end_rays_at_moving(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int count) {
  for (int first = 0; first < count; first += LANES) {
    int enters[LANES];
    clear_moving_hits(paths, first);
    enter_moving(scene, paths, first, enters);
    for (int i = first; i < min_i(first + LANES, count); i++) {
      if (enters[i - first] == 0) continue;
      const int skip_instance = NEEDS(scene, INSTANCES) ? get_ray_skip_instance(paths, i) : -1;
      const Hit hit = intersect_moving(scene, get_ray_origin(paths, i), get_ray_direction(paths, i),
                                       get_ray_tmax(paths, i), get_ray_skip(paths, i), skip_instance,
                                       get_time(paths, i), false);
      if (hit.primitive < 0) continue;
      set_moving_hit(paths, i, hit.primitive);
      set_moving_instance(paths, i, hit.instance);
      set_ray_tmax(paths, i, hit.t);
    }
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
  for (int first = 0; first < count; first += LANES) {
    int enters[LANES];
    enter_moving_by_shadow_rays(scene, paths, first, enters);
    for (int i = first; i < min_i(first + LANES, count); i++) {
      if (enters[i - first] == 0 || !(get_shadow_transmittance(paths, i) > 0.0f)) continue;
      const int skip_instance = NEEDS(scene, INSTANCES) ? get_shadow_skip_instance(paths, i) : -1;
      const Hit hit = intersect_moving(scene, get_shadow_origin(paths, i), get_shadow_direction(paths, i),
                                       get_shadow_tmax(paths, i), get_shadow_skip(paths, i), skip_instance,
                                       get_time(paths, i), true);
      if (hit.primitive >= 0) set_transmittance_of_hit(scene, paths, i, hit.primitive);
    }
  }
}

PENUMBRA_NAMESPACE_END
#endif
