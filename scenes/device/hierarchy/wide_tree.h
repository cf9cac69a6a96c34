// Trees of up to BVH_WIDTH children a node, before they are flattened.
#pragma once

#include <memory>

#include "kernels/host/bounds.h"
#include "kernels/intersect/bvh_limits.h"

namespace penumbra {

/// Levels of nodes over one kind of primitive: the root over all kinds is above them, and a margin.
constexpr int kMaxTreeDepth = BVH_MAX_DEPTH - 2;

/// Either an inner node or a leaf.
struct TreeNode {
  int child_count;  ///< 0: it is a leaf
};
struct WideNode : TreeNode {
  Box bounds[BVH_WIDTH];  ///< of the children
  const TreeNode* children[BVH_WIDTH];
};
struct WideLeaf : TreeNode {
  int primitive_count;
  int primitives[BVH_WIDTH];
};

/// A tree and what it is in.
struct WideTree {
  const TreeNode* root = nullptr;  ///< null: there is none
  std::shared_ptr<void> memory;
};

}  // namespace penumbra
