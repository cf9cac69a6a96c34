#include "worker/search_choice.h"

#include "kernels/host/bounds.h"
#include "kernels/host/device_scene.h"

namespace penumbra {
namespace {

/// Costs in cycles, measured by tests/benchmarks/traversal_benchmark.cpp (Zen 4; only their ratios matter).
struct SearchCosts {
  double vertex, primitive;  ///< per ray, when testing every primitive
  double node, leaf;         ///< per visit
};

SearchCosts costs_of(Isa isa) {
  if (isa == Isa::kAvx512) return {0.56, 1.31, 69, 56};
  if (isa == Isa::kAvx2) return {0.76, 1.77, 69, 56};
  return {1.91, 4.46, 40, 110};
}

struct Visits {
  double nodes = 1, leaves = 0;
};

/// The expected visits of a ray that meets the scene: boxes are visited in proportion to their surface area
/// (Goldsmith and Salmon 1987). A closed room has larger boxes than a plain with a few objects.
Visits expected_visits(std::span<const BvhNode> nodes) {
  const auto box_of = [](const BvhNode& node, int child) {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = node.bounds[axis][child];
      box.high[axis] = node.bounds[axis + 3][child];
    }
    return box;
  };
  Box scene;
  for (int child = 0; child < BVH_WIDTH; ++child) scene.include(box_of(nodes.front(), child));
  Visits visits;
  for (const BvhNode& node : nodes)
    for (int child = 0; child < BVH_WIDTH; ++child) {
      const Box box = box_of(node, child);
      if (box.low[0] <= box.high[0])  // not an empty slot
        (node.child[child] < 0 ? visits.leaves : visits.nodes) += half_area(box) / half_area(scene);
    }
  return visits;
}

}  // namespace

bool tests_every_primitive(Isa isa, const DeviceScene& scene) {
  const TableSpans& tables = scene.header.tables;
  const SearchCosts costs = costs_of(isa);
  const double whole = costs.vertex * tables.vertices.count +
                       costs.primitive * (tables.triangles.count + tables.quadrics.count);
  const Visits visits = expected_visits(table<BvhNode>(scene, tables.nodes));
  return whole <= costs.node * visits.nodes + costs.leaf * visits.leaves;
}

}  // namespace penumbra
