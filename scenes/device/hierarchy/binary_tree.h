// A binary tree over parts of primitives.
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
    int child[2] = {-1, -1};
    int primitive = -1;  ///< -1 for an inner node
    [[nodiscard]] bool is_inner() const { return primitive < 0; }
  };
  std::vector<Node> nodes;  ///< the root is first

  [[nodiscard]] Node& operator[](int node) { return nodes[std::size_t(node)]; }
  [[nodiscard]] const Node& operator[](int node) const { return nodes[std::size_t(node)]; }

  /// Appends a node, which becomes a child of the parent; the root has -1.
  int add_node(const Box& box, int parent);
  /// Appends a tree over a few parts under `parent`. Reorders the parts.
  void add_parts(std::span<TreePart> parts, int parent);
};

}  // namespace penumbra
