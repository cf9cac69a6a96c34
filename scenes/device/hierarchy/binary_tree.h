// A binary tree over parts of primitives, and an optimisation that makes it faster to trace.
#pragma once

#include <span>
#include <vector>

#include "kernels/host/bounds.h"

namespace penumbra {

/// The part of a primitive inside a box. Triangles may be split into several parts.
struct TreePart {
  Box box;
  int primitive;
};

/// A binary tree. A node is either inner, with two children, or holds one part.
struct BinaryTree {
  struct Node {
    Box box;
    int parent = -1;  ///< -1 for the root
    int child[2] = {-1, -1};
    int primitive = -1;  ///< -1 for an inner node
    [[nodiscard]] bool is_inner() const { return primitive < 0; }
  };
  std::vector<Node> nodes;  ///< the root is first

  [[nodiscard]] Node& operator[](int node) { return nodes[std::size_t(node)]; }
  [[nodiscard]] const Node& operator[](int node) const { return nodes[std::size_t(node)]; }

  /// For each node, whether it holds a part.
  [[nodiscard]] std::vector<char> is_part() const;
  /// Appends a node as a child of `parent`.
  int add_node(const Box& box, int parent);
  /// Appends a tree over a few parts under `parent`. Reorders the parts.
  void add_parts(std::span<TreePart> parts, int parent);
};

/// Moves subtrees so that the tree's boxes become smaller, largest boxes first. Each subtree is removed and
/// inserted again next to the node where the total surface area grows least (after Bittner, Hapala and Havran
/// 2013, Fast Insertion-Based Optimization of Bounding Volume Hierarchies). Nodes below one marked in
/// `is_leaf` are not considered. Each of the `passes` tries the fraction `share` of the nodes. The total
/// surface area never grows.
void move_subtrees(BinaryTree& tree, std::span<const char> is_leaf, double share, int passes);

}  // namespace penumbra
