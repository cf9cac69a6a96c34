// Branches that paths have left for later, for integrators that follow several. A path takes one branch and
// stacks the others; when it ends, it takes the last one stacked. The order is depth first, so a path never
// has more than one stacked branch for each surface between it and the camera.
#ifndef PENUMBRA_BRANCHES_H
#define PENUMBRA_BRANCHES_H
#include "kernels/integrator/step.h"

PENUMBRA_NAMESPACE_BEGIN

/// The random sequence of another branch of a path with sequence `hash`. Its samples are distributed over the
/// same neighbouring pixels.
FN int branch_sequence(int hash, int branch) {
  const uint other = hash_uint((uint)hash ^ hash_uint((uint)branch));
  return (int)((other & ~TILE_PLACE) | ((uint)hash & TILE_PLACE));
}

STAGE void start_branches(const PRIVATE PathState* paths, int i) {
  LANE_LOOP
    for (int j = i; j < i + LANES; j++) {
      set_branch_place(paths, j, j);
      set_branch_count(paths, j, 0);
      set_revisit(paths, j, 0);
    }
}

/// The branch that traces the path's last ray again.
FN Branch arriving_branch(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int more) {
  Branch b;
  b.origin = get_ray_origin(paths, i);
  b.direction = get_ray_direction(paths, i);
  b.throughput = get_throughput(paths, i);
  b.depth = get_depth(paths, i);
  b.skip = get_ray_skip(paths, i);
  b.instance = -1;
  if (NEEDS(scene, INSTANCES)) b.instance = get_ray_skip_instance(paths, i);
  b.eta = 1.0f;
  if (NEEDS(scene, TRANSMISSION)) b.eta = get_eta(paths, i);
  b.pixel_hash = get_pixel_hash(paths, i);
  b.more = more;
  return b;
}

FN void push_branch(const PRIVATE PathState* paths, int i, Branch b) {
  const int count = get_branch_count(paths, i);
  stack_branch(paths, get_branch_place(paths, i), count, b);
  set_branch_count(paths, i, count + 1);
}

/// The path continues along the branch. Lights on its next hit get full weight, since no other strategy
/// samples them: the ray leaves a mirror or leads back to a surface.
FN void follow_branch(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, Branch b) {
  set_ray_origin(paths, i, b.origin);
  set_ray_direction(paths, i, b.direction);
  set_ray_tmax(paths, i, NO_LIMIT);
  set_ray_skip(paths, i, b.skip);
  if (NEEDS(scene, INSTANCES)) set_ray_skip_instance(paths, i, b.instance);
  set_direction_pdf(paths, i, DELTA_PDF);
  set_throughput(paths, i, b.throughput);
  set_depth(paths, i, b.depth);
  set_revisit(paths, i, b.more);
  set_pixel_hash(paths, i, b.more > 0 ? branch_sequence(b.pixel_hash, b.more) : b.pixel_hash);
  set_alive(paths, i, true);
  if (NEEDS(scene, TRANSMISSION)) set_eta(paths, i, b.eta);
  if (NEEDS(scene, POLYGONS)) set_left_controlled(paths, i, false);
}

/// Paths from lane i on that have ended take their last branch, if they have one. `count` is the number of
/// lanes with paths; lanes beyond repeat the last path, whose branches are not theirs.
STAGE void take_branches(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, int count) {
  for (int j = i; j < min_i(i + LANES, count); j++) {
    const int branches = get_branch_count(paths, j), place = get_branch_place(paths, j);
    if (get_alive(paths, j) || branches == 0) continue;
    Branch b = stacked_branch(paths, place, branches - 1);
    follow_branch(scene, paths, j, b);
    b.more--;
    if (b.more > 0)
      stack_branch(paths, place, branches - 1, b);
    else
      set_branch_count(paths, j, branches - 1);
  }
}

PENUMBRA_NAMESPACE_END
#endif
