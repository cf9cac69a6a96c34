#include "kernels/host/hierarchy_check.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/intersect/bvh_limits.h"

namespace penumbra {
namespace {

bool is_leaf(const HierarchyTables& hierarchy, int instances, int leaf) {
  if (leaf >= FIRST_INSTANCE_LEAF) return leaf - FIRST_INSTANCE_LEAF < instances;
  if (leaf >= FIRST_QUADRIC_LEAF)
    return std::size_t(leaf - FIRST_QUADRIC_LEAF) < hierarchy.quadric_leaves.size();
  return std::size_t(leaf) < hierarchy.triangle_leaves.size();
}

/// Children come after their only parent, in empty slots too, so that every traversal ends. The subtree of a
/// group has no instances.
std::string node_problem(const HierarchyTables& hierarchy) {
  const std::span<const BvhNode> nodes = hierarchy.nodes;
  const std::span<const int> roots = hierarchy.roots;
  const int count = int(nodes.size());
  std::vector<int> depth(nodes.size(), 0);
  std::vector<bool> in_group(nodes.size(), false);
  depth[0] = 1;
  for (std::size_t g = 0; g < roots.size(); ++g) {
    if (g == 0 ? roots[g] != 0 : roots[g] < 1 || roots[g] >= count) return "a group's root is not there";
    const auto root = std::size_t(roots[g]);
    if (g > 0 && depth[root] != 0) return "two groups have one root";
    depth[root] = 1;
    in_group[root] = g > 0;
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (depth[i] == 0) return "a BVH node has no parent";
    if (depth[i] > BVH_MAX_DEPTH) return "the hierarchy is too deep";
    const int instances = in_group[i] ? 0 : hierarchy.instances;
    for (const int child : nodes[i].child) {
      if (child < 0) {
        if (!is_leaf(hierarchy, instances, ~child)) return "a BVH node names a leaf that is not there";
        continue;
      }
      if (child <= int(i) || child >= count) return "a BVH node names a child that is not there";
      const auto next = std::size_t(child);
      if (depth[next] != 0) return "a BVH node has two parents";
      depth[next] = depth[i] + 1;
      in_group[next] = in_group[i];
    }
  }
  return {};
}

/// Whether each of the leaves' primitives is in [first, end), or -1 for none.
template <typename Leaf>
bool are_there(std::span<const Leaf> leaves, std::int64_t first, std::int64_t end) {
  for (const Leaf& leaf : leaves)
    for (const int primitive : leaf.primitive)
      if (primitive != -1 && (primitive < first || primitive >= end)) return false;
  return true;
}

}  // namespace

std::string hierarchy_problem(const HierarchyTables& hierarchy) {
  if (hierarchy.nodes.empty()) return "a hierarchy without a root";
  if (hierarchy.triangle_leaves.empty() && hierarchy.quadric_leaves.empty())
    return "a hierarchy without leaves";
  if (std::string problem = node_problem(hierarchy); !problem.empty()) return problem;
  const std::int64_t triangles = hierarchy.triangles;
  if (!are_there(hierarchy.triangle_leaves, 0, triangles))
    return "a BVH leaf names a triangle that is not there";
  if (!are_there(hierarchy.quadric_leaves, triangles, triangles + hierarchy.quadrics))
    return "a BVH leaf names a quadric that is not there";
  return {};
}

}  // namespace penumbra
