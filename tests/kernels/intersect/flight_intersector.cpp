// Interleaved traversal of a block's rays, for any instruction set that the tests are compiled for. The
// number of rays is small and odd, so that lists fill, end and restart within a test.
#define RAYS_IN_FLIGHT 7
#include "kernels/block/block_trace.h"
#include "kernels/host/block_memory.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {

std::vector<int> trace_in_flight(SceneTables& tables, std::span<const TestRay> rays, bool any) {
  Scene scene = tables.scene();
  scene.header.integrator.trace_shadows = 1;
  scene.header.features |= FEATURE_BVH;
  const int count = int(rays.size());
  BlockMemory memory(FEATURE_ALL, (count + LANES) / LANES * LANES, 0);
  const PathState paths = memory.block().paths;
  for (int i = 0; i < count; ++i) {
    const TestRay& ray = rays[std::size_t(i)];
    set_ray_origin(&paths, i, ray.origin);
    set_ray_direction(&paths, i, ray.direction);
    set_ray_tmax(&paths, i, ray.tmax);
    set_ray_skip(&paths, i, ray.skip);
    set_shadow_origin(&paths, i, ray.origin);
    set_shadow_direction(&paths, i, ray.direction);
    set_shadow_tmax(&paths, i, ray.tmax);
    set_shadow_skip(&paths, i, ray.skip);
    set_shadow_transmittance(&paths, i, 1.0f);
  }
  if (any)
    occlude_block(&scene, &paths, count);
  else
    intersect_block(&scene, &paths, count, false);
  std::vector<int> hits;
  for (int i = 0; i < count; ++i)
    hits.push_back(any ? (get_shadow_transmittance(&paths, i) > 0 ? -1 : 0) : get_hit(&paths, i));
  return hits;
}

}  // namespace penumbra
