// Collapses a binary tree into one with up to BVH_WIDTH children per node and as many primitives per leaf.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scenes/device/hierarchy/binary_tree.h"
#include "scenes/device/hierarchy/wide_tree.h"

namespace penumbra {

/// Chooses which nodes of the binary tree become nodes and leaves of the wide tree, so that the total surface
/// area is minimal. This minimises the expected number of nodes that a random line visits, with a leaf as
/// expensive as a node. It uses dynamic programming over forests of up to BVH_WIDTH - 1 trees (after Ylitie,
/// Karras and Laine 2017, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs).
class TreeCollapse {
 public:
  explicit TreeCollapse(const BinaryTree& tree);

  /// The surfaces of the wide tree's boxes over that of the root; 0 if the root has none.
  [[nodiscard]] double cost() const { return forests_.front().cost[1]; }
  /// The wide tree. Of a node's children, the last has the fewest parts. A leaf holds each primitive once.
  [[nodiscard]] WideTree wide_tree() const;

 private:
  /// The costs of representing the subtree by up to k trees.
  struct Forest {
    std::array<float, BVH_WIDTH> cost;  ///< for k up to BVH_WIDTH - 1
    /// The number of trees given to the first child; 0: k - 1 trees are as good.
    std::array<std::int8_t, BVH_WIDTH + 1> to_first;
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
