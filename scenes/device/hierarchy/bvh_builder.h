// The portable intersector's hierarchy. Embree's builder makes a binary tree with full leaves and splits
// large triangles. The cheapest tree with 8 children a node is then taken from it (tree_collapse.h). Scenes
// of more than a million primitives, and trees too deep for a ray's stack, keep Embree's own tree.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "kernels/host/bounds.h"
#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "kernels/scene_types.h"

namespace penumbra {

struct Hierarchy {
  std::vector<BvhNode> nodes;  ///< the root first; children come after their parent
  std::vector<int> roots;      ///< for each group its root node
  std::vector<TriangleLeaf> triangle_leaves;
  std::vector<QuadricLeaf> quadric_leaves;
  StillRecords still;
};

/// What a hierarchy is over. Group 0 is the scene itself, with all instances; it may be empty if there are
/// instances. Every other group must have primitives.
struct HierarchyInput {
  std::span<const Triangle> triangles;
  std::span<const Quadric> quadrics;
  std::span<const PrimitiveGroup> groups;
  std::span<const Instance> instances;
  /// In a scene with motion, what is still, which must be something. The primitives of still groups come
  /// first, then the still ones of group 0. There are separate trees over what is still and what moves, below
  /// one root. The still one's records come first, and do not depend on what moves except for its extent.
  std::optional<StillRecords> still = {};
};

/// A leaf with the vertices of these of all triangles; -1: none.
TriangleLeaf triangle_leaf(std::span<const int, BVH_WIDTH> primitives, std::span<const Triangle> triangles);

/// The box in which rays may hit a group's primitives, in its own space.
Box group_bounds(std::span<const Triangle> triangles, std::span<const Quadric> quadrics,
                 const PrimitiveGroup& group);

/// The bounds of a placed group, enlarged by `margin`, that of the rounding errors of rays that enter the
/// group from anywhere in a scene of that extent.
struct PlacedBounds {
  Box box;
  double margin = 0;
};
PlacedBounds placed_bounds(const Instance& instance, const Box& group, double extent);

/// Builds the hierarchy over all triangles and quadrics, of which there must be at least one. It uses
/// Embree's builder with a fixed instruction set on all cores. The same scene always gets the same hierarchy.
Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics);

/// Builds one hierarchy over the primitives of group 0 and the instances, and one for every other group over
/// its primitives.
Expected<Hierarchy> build_hierarchy(const HierarchyInput& input, int threads = 0);
Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics,
                                    std::span<const PrimitiveGroup> groups,
                                    std::span<const Instance> instances, int threads = 0);

/// The two steps of build_hierarchy where something is still: the root and all that is still, to which then
/// what moves is added. Quadric leaves name primitives by the number of all triangles.
Expected<Hierarchy> build_still(const HierarchyInput& input, int threads = 0);
/// `hierarchy`: its records after those of `still` have been removed, if there were any.
Expected<void> add_moving(const HierarchyInput& input, Hierarchy& hierarchy, int threads = 0);
/// What `still` of such a hierarchy is.
StillRecords still_part(const HierarchyInput& input, const Hierarchy& hierarchy);
/// The extent of the scene on which the still part depends.
double hierarchy_extent(const HierarchyInput& input);

}  // namespace penumbra
