// Trees with up to BVH_WIDTH children per node, before they are flattened.
#pragma once

#include <memory>

#include "kernels/host/bounds.h"
#include "kernels/intersect/bvh_limits.h"

namespace penumbra {

/// The largest depth of a tree over one kind of primitive. It leaves room for the common root above and a
/// margin.
constexpr int kMaxTreeDepth = BVH_MAX_DEPTH - 2;

/// An inner node or a leaf.
struct TreeNode {
  int child_count;  ///< 0 for a leaf
};
struct WideNode : TreeNode {
  Box bounds[BVH_WIDTH];  ///< bounds of the children
  const TreeNode* children[BVH_WIDTH];
};
struct WideLeaf : TreeNode {
  int primitive_count;
  int primitives[BVH_WIDTH];
};

/// A tree and the memory that holds it.
struct WideTree {
  const TreeNode* root = nullptr;  ///< null if there is no tree
  std::shared_ptr<void> memory;
};

}  // namespace penumbra
