// The portable intersector's hierarchy. Embree's builder makes a binary tree with full leaves and splits
// large triangles. The cheapest tree with 8 children a node is then taken from it (tree_collapse.h). Scenes
// of more than a million primitives, and trees too deep for a ray's stack, keep Embree's own tree.
#pragma once

#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "kernels/scene_types.h"

namespace penumbra {

struct Hierarchy {
  std::vector<BvhNode> nodes;  ///< the root first; children come after their parent
  std::vector<int> roots;      ///< for each group its root node
  std::vector<TriangleLeaf> triangle_leaves;
  std::vector<QuadricLeaf> quadric_leaves;
};

/// A leaf with the vertices of these of all triangles; -1: none.
TriangleLeaf triangle_leaf(std::span<const int, BVH_WIDTH> primitives, std::span<const Triangle> triangles);

/// Builds the hierarchy over all triangles and quadrics, of which there must be at least one. It uses
/// Embree's builder with a fixed instruction set on all cores. The same scene always gets the same hierarchy.
Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics);

/// Builds one hierarchy over the primitives of group 0 and the instances, and one for every other group over
/// its primitives. Group 0 may be empty if there are instances. Every other group must have primitives.
Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics,
                                    std::span<const PrimitiveGroup> groups,
                                    std::span<const Instance> instances, int threads = 0);

}  // namespace penumbra
