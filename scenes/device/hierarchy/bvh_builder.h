// The portable intersector's hierarchy. Embree's builder makes a binary tree with full leaves and splits
// large triangles. The cheapest tree with 8 children a node is then taken from it (tree_collapse.h). Scenes of
// more than a million primitives, and trees too deep for a ray's stack, keep Embree's own tree.
#pragma once

#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "kernels/scene_types.h"

namespace penumbra {

struct Hierarchy {
  std::vector<BvhNode> nodes;  ///< the root first; children after their parent
  std::vector<int> roots;      ///< of each group, a node
  std::vector<TriangleLeaf> triangle_leaves;
  std::vector<QuadricLeaf> quadric_leaves;
};

/// Over all triangles and quadrics; at least one of either. Built by Embree's builder with a
/// fixed instruction set, on all cores: the same scene always gets the same hierarchy.
Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics);

/// Over the primitives of group 0 and the instances, and for each other group over its primitives. Group 0
/// may be empty where there are instances, the others have primitives.
Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics,
                                    std::span<const PrimitiveGroup> groups,
                                    std::span<const Instance> instances, int threads = 0);

}  // namespace penumbra
