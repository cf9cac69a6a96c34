// A binary tree over parts of primitives, and how it is made cheaper to trace.
#pragma once

#include <span>
#include <vector>

#include "kernels/host/bounds.h"

namespace penumbra {

/// The part of a primitive that is in a box: triangles may be split.
struct TreePart {
  Box box;
  int primitive;
};

/// Every node is either inner, with two children, or holds one part.
struct BinaryTree {
  struct Node {
    Box box;
    int parent = -1;  ///< of the root: -1
    int child[2] = {-1, -1};
    int primitive = -1;  ///< of an inner node: -1
    [[nodiscard]] bool is_inner() const { return primitive < 0; }
  };
  std::vector<Node> nodes;  ///< the root first

  [[nodiscard]] Node& operator[](int node) { return nodes[std::size_t(node)]; }
  [[nodiscard]] const Node& operator[](int node) const { return nodes[std::size_t(node)]; }

  /// Of each node, whether it holds a part.
  [[nodiscard]] std::vector<char> is_part() const;
  /// Appends a node, which becomes a child of the parent.
  int add_node(const Box& box, int parent);
  /// Appends a tree over a few parts, which are left in some other order.
  void add_parts(std::span<TreePart> parts, int parent);
};

/// Moves subtrees to where they make the tree's boxes smaller, the largest boxes first: one after the other
/// is taken out and put beside the node where the sum of surfaces grows least (after Bittner, Hapala and
/// Havran 2013, Fast Insertion-Based Optimization of Bounding Volume Hierarchies). `is_leaf` says of which
/// nodes nothing below is looked at. Each of the passes tries this share of the nodes. The sum never grows.
void move_subtrees(BinaryTree& tree, std::span<const char> is_leaf, double share, int passes);

}  // namespace penumbra
