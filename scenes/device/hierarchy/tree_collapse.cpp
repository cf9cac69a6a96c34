#include "scenes/device/hierarchy/tree_collapse.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <utility>

namespace penumbra {
namespace {

/// All nodes with parents before their children.
std::vector<int> from_the_root(const BinaryTree& tree) {
  std::vector<int> order, left = {0};
  order.reserve(tree.nodes.size());
  while (!left.empty()) {
    const int node = left.back();
    left.pop_back();
    order.push_back(node);
    if (tree[node].is_inner()) left.insert(left.end(), {tree[node].child[0], tree[node].child[1]});
  }
  return order;
}

}  // namespace

TreeCollapse::TreeCollapse(const BinaryTree& tree)
    : tree_(tree), forests_(tree.nodes.size()), is_leaf_(tree.nodes.size(), 0) {
  const double whole = half_area(tree.nodes.front().box);
  const std::vector<int> order = from_the_root(tree);
  for (auto node = order.rbegin(); node != order.rend(); ++node) {
    const float area = whole > 0 ? float(half_area(tree[*node].box) / whole) : 0.0f;
    const auto i = std::size_t(*node);
    forests_[i] = forest_of(tree[*node], area, is_leaf_[i]);
  }
}

TreeCollapse::Forest TreeCollapse::forest_of(const BinaryTree::Node& node, float area, char& is_leaf) const {
  Forest forest{};
  if (!node.is_inner()) {
    forest.cost.fill(area);
    forest.parts = 1;
    is_leaf = 1;
    return forest;
  }
  const Forest &first = forests_[std::size_t(node.child[0])], &second = forests_[std::size_t(node.child[1])];
  std::array<float, BVH_WIDTH + 1> apart;  // cost of k trees that are divided between both children
  for (int k = 2; k <= BVH_WIDTH; ++k) {
    apart[std::size_t(k)] = std::numeric_limits<float>::infinity();
    for (int j = 1; j < k; ++j) {
      const float cost = first.cost[std::size_t(j)] + second.cost[std::size_t(k - j)];
      if (cost >= apart[std::size_t(k)]) continue;
      apart[std::size_t(k)] = cost;
      forest.to_first[std::size_t(k)] = std::int8_t(j);
    }
  }
  forest.parts = first.parts + second.parts;
  const float as_node = apart[BVH_WIDTH] + area;
  is_leaf = forest.parts <= BVH_WIDTH && area <= as_node ? 1 : 0;
  forest.cost[1] = is_leaf != 0 ? area : as_node;
  for (std::size_t k = 2; k < BVH_WIDTH; ++k) {
    forest.cost[k] = std::min(apart[k], forest.cost[k - 1]);
    if (apart[k] >= forest.cost[k - 1]) forest.to_first[k] = 0;
  }
  return forest;
}

/// Lists the roots of the trees of the node's subtree.
void TreeCollapse::list_trees(int node, int trees, std::vector<int>& roots) const {
  const Forest& forest = forests_[std::size_t(node)];
  while (trees > 1 && forest.to_first[std::size_t(trees)] == 0) --trees;
  if (trees == 1) {
    roots.push_back(node);
    return;
  }
  const int to_first = forest.to_first[std::size_t(trees)];
  list_trees(tree_[node].child[0], to_first, roots);
  list_trees(tree_[node].child[1], trees - to_first, roots);
}

class TreeCollapse::Emitter {
 public:
  explicit Emitter(const TreeCollapse& from) : from_(from), made_(std::make_shared<Made>()) {}

  WideTree wide_tree() {
    const TreeNode* root = emit(0);
    return {root, made_};
  }

 private:
  struct Made {
    std::deque<WideNode> nodes;
    std::deque<WideLeaf> leaves;
  };

  const TreeNode* emit(int node) {
    if (from_.is_leaf_[std::size_t(node)] != 0) {
      WideLeaf& leaf = made_->leaves.emplace_back();
      add_primitives(node, leaf);
      return &leaf;
    }
    std::vector<int> children;
    from_.list_trees(node, BVH_WIDTH, children);
    std::ranges::sort(children, {}, [this](int child) {
      return std::pair(-from_.forests_[std::size_t(child)].parts, child);
    });
    WideNode& wide = made_->nodes.emplace_back();
    wide.child_count = int(children.size());
    for (std::size_t k = 0; k < children.size(); ++k) {
      wide.bounds[k] = from_.tree_[children[k]].box;
      wide.children[k] = emit(children[k]);
    }
    return &wide;
  }

  void add_primitives(int node, WideLeaf& leaf) {
    const BinaryTree::Node& from = from_.tree_[node];
    if (from.is_inner()) {
      for (const int child : from.child) add_primitives(child, leaf);
      return;
    }
    const auto end = leaf.primitives + leaf.primitive_count;
    if (std::find(leaf.primitives, end, from.primitive) != end) return;
    leaf.primitives[leaf.primitive_count++] = from.primitive;
  }

  const TreeCollapse& from_;
  std::shared_ptr<Made> made_;
};

WideTree TreeCollapse::wide_tree() const { return Emitter(*this).wide_tree(); }

}  // namespace penumbra
