// Checks that searches in a hierarchy end, and name only what is there.
#pragma once

#include <span>
#include <string>

#include "kernels/scene_types.h"

namespace penumbra {

/// The tables of a hierarchy, and the numbers of what it is over.
struct HierarchyTables {
  std::span<const BvhNode> nodes;
  std::span<const int> roots;  ///< for each group its root node
  std::span<const TriangleLeaf> triangle_leaves;
  std::span<const QuadricLeaf> quadric_leaves;
  int triangles = 0, quadrics = 0, instances = 0;
};

/// What is wrong with it; empty: nothing.
std::string hierarchy_problem(const HierarchyTables& hierarchy);

}  // namespace penumbra
