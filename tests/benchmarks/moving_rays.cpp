// Traversal of what moves for one instruction set: see moving_rays.h.
#include "tests/benchmarks/moving_rays.h"

#include "kernels/motion/motion_bvh.h"

namespace penumbra {

int STAGE_FUNCTION(const SceneHeader& header, const uint* words, bool any, const MovingRayCase* rays,
                   int count) {
  const Scene scene = make_scene(header, words);
  int hits = 0;
  for (int i = 0; i < count; ++i) {
    const MovingRayCase& ray = rays[i];
    const Hit hit = intersect_moving(&scene, ray.origin, ray.direction, 1e30f, -1, -1, ray.time, any);
    hits += hit.primitive >= 0 ? 1 : 0;
  }
  return hits;
}

}  // namespace penumbra
