#include "worker/search_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "kernels/host/device_scene_tables.h"

namespace penumbra {
namespace {

/// Cycles, measured by tests/benchmarks/traversal_benchmark.cpp (Zen 4; only their ratios matter).
struct SearchCosts {
  double vertex, primitive;  ///< a ray's share of testing the scene whole
  double node, leaf;         ///< a visit
};

SearchCosts costs_of(KernelTarget target) {
  switch (target) {
    case KernelTarget::kAvx512:
      return {0.56, 1.31, 69, 56};
    case KernelTarget::kAvx2:
      return {0.76, 1.77, 69, 56};
    case KernelTarget::kSse2:
      return {1.91, 4.46, 40, 110};
    case KernelTarget::kScalar:
      break;  // one ray at a time
  }
  return {std::numeric_limits<double>::infinity(), 0, 0, 0};
}

struct Visits {
  double nodes = 1, leaves = 0;
};

/// What a ray that meets the scene visits if it goes anywhere: boxes in proportion to their surface
/// (Goldsmith and Salmon 1987), of which a closed room has larger ones than a plain with a few things on it.
Visits expected_visits(std::span<const BvhNode> nodes) {
  const auto surface = [](const std::array<double, 6>& b) {
    const double x = b[3] - b[0], y = b[4] - b[1], z = b[5] - b[2];
    return x * y + y * z + z * x;
  };
  const auto box_of = [](const BvhNode& node, int child) {
    std::array<double, 6> box{};
    for (std::size_t row = 0; row < 6; ++row) box[row] = double(node.bounds[row][child]);
    return box;
  };
  const auto is_there = [](const std::array<double, 6>& b) { return b[0] <= b[3]; };
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::array<double, 6> scene = {kFar, kFar, kFar, -kFar, -kFar, -kFar};
  for (int child = 0; child < BVH_WIDTH; ++child) {
    const auto box = box_of(nodes.front(), child);
    if (!is_there(box)) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      scene[axis] = std::min(scene[axis], box[axis]);
      scene[axis + 3] = std::max(scene[axis + 3], box[axis + 3]);
    }
  }
  Visits visits;
  for (const BvhNode& node : nodes)
    for (int child = 0; child < BVH_WIDTH; ++child) {
      const auto box = box_of(node, child);
      if (is_there(box))
        (node.child[child] < 0 ? visits.leaves : visits.nodes) += surface(box) / surface(scene);
    }
  return visits;
}

}  // namespace

bool tests_whole(KernelTarget target, const DeviceScene& scene) {
  const TableSpans& tables = scene.header.tables;
  const SearchCosts costs = costs_of(target);
  const double whole = costs.vertex * tables.vertices.count +
                       costs.primitive * (tables.triangles.count + tables.quadrics.count);
  const Visits visits = expected_visits(table<BvhNode>(scene, tables.nodes));
  return whole <= costs.node * visits.nodes + costs.leaf * visits.leaves;
}

}  // namespace penumbra
