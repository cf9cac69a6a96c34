// A binary tree over parts of primitives.
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
    int child[2] = {-1, -1};
    int primitive = -1;  ///< of an inner node: -1
    [[nodiscard]] bool is_inner() const { return primitive < 0; }
  };
  std::vector<Node> nodes;  ///< the root first

  [[nodiscard]] Node& operator[](int node) { return nodes[std::size_t(node)]; }
  [[nodiscard]] const Node& operator[](int node) const { return nodes[std::size_t(node)]; }

  /// Appends a node, which becomes a child of the parent; the root has -1.
  int add_node(const Box& box, int parent);
  /// Appends a tree over a few parts, which are left in some other order.
  void add_parts(std::span<TreePart> parts, int parent);
};

}  // namespace penumbra
