// Binary trees over parts, moved subtrees, and the wide trees made from them, against exhaustive search.
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

double sum_of_surfaces(const BinaryTree& tree) {
  double sum = 0;
  for (const BinaryTree::Node& node : tree.nodes)
    if (node.is_inner()) sum += half_area(node.box);
  return sum;
}

bool same(const Box& a, const Box& b) {
  return std::ranges::equal(a.low, b.low) && std::ranges::equal(a.high, b.high);
}

/// Parents and children know each other, boxes are those about the children; counts the parts.
void expect_sound(const BinaryTree& tree, int node, std::vector<int>& seen) {
  if (!tree[node].is_inner()) {
    ++seen[std::size_t(tree[node].primitive)];
    return;
  }
  Box box;
  for (const int child : tree[node].child) {
    ASSERT_EQ(tree[child].parent, node);
    box.include(tree[child].box);
    expect_sound(tree, child, seen);
  }
  ASSERT_TRUE(same(box, tree[node].box)) << node;
}

class RandomTrees : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Parts, RandomTrees, testing::Values(1, 2, 3, 4, 9, 24, 200, 3000));

TEST_P(RandomTrees, HoldEveryPartOnceBeforeAndAfterMoves) {
  BinaryTree tree = tree_over(random_parts(GetParam(), 1));
  double sum = sum_of_surfaces(tree);
  for (const double share : {0.0, 0.05, 1.0}) {
    std::vector<int> seen(std::size_t(GetParam()), 0);
    expect_sound(tree, 0, seen);
    EXPECT_EQ(std::ranges::count(seen, 1), GetParam());
    move_subtrees(tree, tree.is_part(), share, 2);
    EXPECT_LE(sum_of_surfaces(tree), sum * (1 + 1e-12));
    sum = sum_of_surfaces(tree);
  }
}

/// What `node` is to be beside another is done to a copy, in the plainest way.
double sum_after_move(BinaryTree tree, int node, int place) {
  const int parent = tree[node].parent, above = tree[parent].parent;
  const int beside = tree[parent].child[tree[parent].child[0] == node ? 1 : 0];
  std::ranges::replace(tree[above].child, parent, beside);
  tree[beside].parent = above;
  std::ranges::replace(tree[tree[place].parent].child, place, parent);
  tree[parent].parent = tree[place].parent;
  tree[parent].child[0] = node;
  tree[parent].child[1] = place;
  tree[place].parent = parent;
  const auto fit = [&tree](const auto& self, int at) -> Box {
    if (!tree[at].is_inner()) return tree[at].box;
    Box box = self(self, tree[at].child[0]);
    box.include(self(self, tree[at].child[1]));
    return tree[at].box = box;
  };
  fit(fit, 0);
  return sum_of_surfaces(tree);
}

bool is_below(const BinaryTree& tree, int node, int top) {
  while (node >= 0 && node != top) node = tree[node].parent;
  return node == top;
}

TEST(SubtreeMoves, EndWhereNoMoveIsBetter) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    BinaryTree tree = tree_over(random_parts(40, seed));
    const double before = sum_of_surfaces(tree);
    move_subtrees(tree, tree.is_part(), 1, 1000);
    const double sum = sum_of_surfaces(tree);
    EXPECT_LT(sum, before);
    int tried = 0;
    for (int node = 0; node < int(tree.nodes.size()); ++node) {
      if (tree[node].parent <= 0) continue;
      for (int place = 1; place < int(tree.nodes.size()); ++place) {
        // Beside what is above it is not looked for: it is there after another's move.
        if (is_below(tree, place, node) || is_below(tree, node, place)) continue;
        ++tried;
        EXPECT_GE(sum_after_move(tree, node, place), sum * (1 - 1e-5)) << node << " beside " << place;
      }
    }
    EXPECT_GT(tried, 1000);
  }
}

TEST(SubtreeMoves, LeaveWhatIsBelowALeafAsItIs) {
  BinaryTree tree = tree_over(random_parts(500, 3));
  const std::vector<char> is_leaf = TreeCollapse(tree).is_leaf();
  const BinaryTree before = tree;
  move_subtrees(tree, is_leaf, 1, 3);
  EXPECT_LT(sum_of_surfaces(tree), sum_of_surfaces(before));
  std::size_t leaves = 0;
  const auto compare = [&](const auto& self, int node) -> void {
    EXPECT_TRUE(same(tree[node].box, before[node].box));
    EXPECT_TRUE(std::ranges::equal(tree[node].child, before[node].child));
    if (tree[node].is_inner())
      for (const int child : tree[node].child) self(self, child);
  };
  const auto visit = [&](const auto& self, int node) -> void {
    if (is_leaf[std::size_t(node)] != 0) {
      ++leaves;
      compare(compare, node);
      return;
    }
    for (const int child : tree[node].child) self(self, child);
  };
  visit(visit, 0);
  EXPECT_GT(leaves, 500u / BVH_WIDTH);
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
  BinaryTree tree = tree_over(points);
  move_subtrees(tree, tree.is_part(), 1, 2);
  std::vector<int> seen(100, 0);
  int count = 0;
  cost_of(TreeCollapse(tree).wide_tree().root, tree.nodes.front().box, seen, count);
  EXPECT_EQ(std::ranges::count(seen, 1), 100);
}

}  // namespace
}  // namespace penumbra
