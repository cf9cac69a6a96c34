// The intersector without BVH.
#include "kernels/intersect/intersect_brute_force.h"

#include <algorithm>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {

namespace {

/// LANES rays from `first` on; behind the last it is repeated.
RayLanes lanes_of(std::span<const TestRay> rays, std::size_t first) {
  RayLanes lanes;
  for (std::size_t j = 0; j < LANES; ++j) {
    const TestRay& ray = rays[std::min(first + j, rays.size() - 1)];
    lanes.ox[j] = ray.origin.x;
    lanes.oy[j] = ray.origin.y;
    lanes.oz[j] = ray.origin.z;
    lanes.dx[j] = ray.direction.x;
    lanes.dy[j] = ray.direction.y;
    lanes.dz[j] = ray.direction.z;
    lanes.tmax[j] = ray.tmax;
    lanes.skip[j] = ray.skip;
  }
  return lanes;
}

}  // namespace

std::vector<TestHit> trace_whole(SceneTables& tables, std::span<const TestRay> rays) {
  const Scene scene = tables.scene();
  std::vector<TestHit> hits(rays.size());
  for (std::size_t first = 0; first < rays.size(); first += LANES) {
    RayLanes lanes = lanes_of(rays, first);
    intersect_brute_force(&scene, &lanes);
    for (std::size_t j = 0; j < LANES && first + j < rays.size(); ++j)
      hits[first + j] = {lanes.hit[j], lanes.tmax[j]};
  }
  return hits;
}

int count_listed(SceneTables& tables, std::span<const TestRay> rays) {
  const Scene scene = tables.scene();
  const RayLanes lanes = lanes_of(rays, 0);
  int listed[MAX_WHOLE_TRIANGLES];
  return cull_triangles(&scene, &lanes, listed);
}

}  // namespace penumbra
