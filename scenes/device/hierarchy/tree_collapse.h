// From a binary tree to one of up to BVH_WIDTH children a node and as many primitives a leaf.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scenes/device/hierarchy/binary_tree.h"
#include "scenes/device/hierarchy/wide_tree.h"

namespace penumbra {

/// Which nodes of the binary tree are nodes and leaves of the wide one, so that the sum of their surfaces is
/// the least there is: as many of them does a line visit that meets all, a leaf being as dear as a node. By
/// dynamic programming over forests of up to BVH_WIDTH - 1 trees (after Ylitie, Karras and Laine 2017,
/// Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs).
class TreeCollapse {
 public:
  explicit TreeCollapse(const BinaryTree& tree);

  /// The surfaces of the wide tree's boxes over that of the root; 0 if the root has none.
  [[nodiscard]] double cost() const { return forests_.front().cost[1]; }
  /// Of children the last has the fewest parts, of which a leaf holds each primitive once.
  [[nodiscard]] WideTree wide_tree() const;

 private:
  /// The subtree as up to k trees.
  struct Forest {
    std::array<float, BVH_WIDTH> cost;                ///< for k up to BVH_WIDTH - 1
    std::array<std::int8_t, BVH_WIDTH + 1> to_first;  ///< of them the first child's; 0: k - 1 are as good
    int parts;
  };
  class Emitter;

  [[nodiscard]] Forest forest_of(const BinaryTree::Node& node, float area, char& is_leaf) const;
  void list_trees(int node, int trees, std::vector<int>& roots) const;

  const BinaryTree& tree_;
  std::vector<Forest> forests_;
  std::vector<char> is_leaf_;
};

}  // namespace penumbra
