// Binary trees over parts, and the wide trees made from them, against exhaustive search.
#include "scenes/device/hierarchy/binary_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "scenes/device/hierarchy/tree_collapse.h"

namespace penumbra {
namespace {

/// Boxes of all sizes about each other; some are large and flat, as walls are.
std::vector<TreePart> random_parts(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(-1, 1), power(-6, 0);
  std::vector<TreePart> parts;
  for (int i = 0; i < count; ++i) {
    const float size = std::exp2(power(random));
    TreePart part{{}, i};
    const vec3 center = make_vec3(at(random), at(random), at(random));
    const float flat = i % 5 == 0 ? 0.0f : size;
    for (const float side : {-1.0f, 1.0f})
      part.box.include(
          make_vec3(center.x + side * size, center.y + side * flat, center.z + side * size * 0.5f));
    parts.push_back(part);
  }
  return parts;
}

BinaryTree tree_over(std::vector<TreePart> parts) {
  BinaryTree tree;
  tree.add_parts(parts, -1);
  return tree;
}

bool same(const Box& a, const Box& b) {
  return std::ranges::equal(a.low, b.low) && std::ranges::equal(a.high, b.high);
}

/// Boxes are those about the children; counts the parts.
void expect_sound(const BinaryTree& tree, int node, std::vector<int>& seen) {
  if (!tree[node].is_inner()) {
    ++seen[std::size_t(tree[node].primitive)];
    return;
  }
  Box box;
  for (const int child : tree[node].child) {
    box.include(tree[child].box);
    expect_sound(tree, child, seen);
  }
  ASSERT_TRUE(same(box, tree[node].box)) << node;
}

class RandomTrees : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Parts, RandomTrees, testing::Values(1, 2, 3, 4, 9, 24, 200, 3000));

TEST_P(RandomTrees, HoldEveryPartOnce) {
  const BinaryTree tree = tree_over(random_parts(GetParam(), 1));
  std::vector<int> seen(std::size_t(GetParam()), 0);
  expect_sound(tree, 0, seen);
  EXPECT_EQ(std::ranges::count(seen, 1), GetParam());
}

int part_count(const BinaryTree& tree, int node) {
  if (!tree[node].is_inner()) return 1;
  return part_count(tree, tree[node].child[0]) + part_count(tree, tree[node].child[1]);
}

/// All ways to cut the tree below a node into up to BVH_WIDTH subtrees.
std::vector<std::vector<int>> cuts(const BinaryTree& tree, int node, bool whole = true) {
  std::vector<std::vector<int>> all;
  if (whole) all.push_back({node});
  if (!tree[node].is_inner()) return all;
  const auto second = cuts(tree, tree[node].child[1]);
  for (const std::vector<int>& a : cuts(tree, tree[node].child[0]))
    for (const std::vector<int>& b : second) {
      if (a.size() + b.size() > BVH_WIDTH) continue;
      all.push_back(a);
      all.back().insert(all.back().end(), b.begin(), b.end());
    }
  return all;
}

/// The least of what all cuts cost.
double least_cost(const BinaryTree& tree, int node) {
  double least = std::numeric_limits<double>::infinity();
  if (part_count(tree, node) > BVH_WIDTH)
    for (const std::vector<int>& cut : cuts(tree, node, false)) {
      double cost = 0;
      for (const int root : cut) cost += least_cost(tree, root);
      least = std::min(least, cost);
    }
  else
    least = 0;
  return least + half_area(tree[node].box);
}

/// Of a wide tree whose root has that box; counts the parts of leaves, and checks the order of children.
double cost_of(const TreeNode* node, const Box& box, std::vector<int>& seen, int& parts) {
  double cost = half_area(box);
  if (node->child_count == 0) {
    const auto* leaf = static_cast<const WideLeaf*>(node);
    for (int i = 0; i < leaf->primitive_count; ++i) ++seen[std::size_t(leaf->primitives[i])];
    parts = leaf->primitive_count;
    return cost;
  }
  const auto* wide = static_cast<const WideNode*>(node);
  int last = std::numeric_limits<int>::max();
  parts = 0;
  for (int k = 0; k < wide->child_count; ++k) {
    int below = 0;
    cost += cost_of(wide->children[k], wide->bounds[k], seen, below);
    EXPECT_LE(below, last);
    last = below;
    parts += below;
  }
  return cost;
}

TEST(TreeCollapse, IsTheCheapestOfAllWaysToCut) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const int count = 9 + int(seed);
    const BinaryTree tree = tree_over(random_parts(count, 100 + seed));
    const TreeCollapse collapse(tree);
    const Box& box = tree.nodes.front().box;
    const double least = least_cost(tree, 0) / half_area(box);
    EXPECT_NEAR(collapse.cost(), least, 64 * 0x1p-24 * least);  // sums of up to 64 floats
    const WideTree wide = collapse.wide_tree();
    std::vector<int> seen(std::size_t(count), 0);
    int parts = 0;
    EXPECT_NEAR(cost_of(wide.root, box, seen, parts) / half_area(box), least, 64 * 0x1p-24 * least);
    EXPECT_EQ(std::ranges::count(seen, 1), count);
  }
}

TEST(TreeCollapse, HoldsEveryPartOfLargeTrees) {
  const BinaryTree tree = tree_over(random_parts(20000, 5));
  const WideTree wide = TreeCollapse(tree).wide_tree();
  std::vector<int> seen(20000, 0);
  int parts = 0;
  cost_of(wide.root, tree.nodes.front().box, seen, parts);
  EXPECT_EQ(parts, 20000);
  EXPECT_EQ(std::ranges::count(seen, 1), 20000);
}

/// Parts of one triangle that come into one leaf are one primitive there; boxes without extent make no order.
TEST(TreeCollapse, ALeafHoldsAPrimitiveOnce) {
  std::vector<TreePart> parts = random_parts(8, 6);
  for (TreePart& part : parts) part.primitive = part.primitive % 3;
  const WideTree wide = TreeCollapse(tree_over(parts)).wide_tree();
  ASSERT_EQ(wide.root->child_count, 0);
  EXPECT_EQ(static_cast<const WideLeaf*>(wide.root)->primitive_count, 3);

  std::vector<TreePart> points(100);
  for (int i = 0; i < 100; ++i) points[std::size_t(i)].primitive = i;
  for (TreePart& part : points) part.box.include(make_vec3(1, 2, 3));
  const BinaryTree tree = tree_over(points);
  std::vector<int> seen(100, 0);
  int count = 0;
  cost_of(TreeCollapse(tree).wide_tree().root, tree.nodes.front().box, seen, count);
  EXPECT_EQ(std::ranges::count(seen, 1), 100);
}

}  // namespace
}  // namespace penumbra
