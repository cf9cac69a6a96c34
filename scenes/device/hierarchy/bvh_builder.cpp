#include "scenes/device/hierarchy/bvh_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "kernels/host/bounds.h"
#include "kernels/host/parallel.h"
#include "kernels/math/math.h"
#include "scenes/device/hierarchy/embree_builder.h"
#include "scenes/device/hierarchy/tree_collapse.h"

namespace penumbra {
namespace {

enum LeafKind { kTriangleLeaf, kQuadricLeaf, kInstanceLeaf, kLeafKinds };

/// A leaf as a child of a node.
int leaf_code(LeafKind kind, std::size_t index) {
  constexpr int kFirst[kLeafKinds] = {0, FIRST_QUADRIC_LEAF, FIRST_INSTANCE_LEAF};
  return ~(kFirst[kind] + int(index));
}

/// Up to so many triangles are split: that takes several times as long as building their tree.
constexpr std::size_t kMostSplit = 1'000'000;

int depth_of(const TreeNode* node) {
  int depth = 0;
  for (int k = 0; k < node->child_count; ++k)
    depth = std::max(depth, 1 + depth_of(static_cast<const WideNode*>(node)->children[k]));
  return depth;
}

Expected<WideTree> tree_over(std::span<const Triangle> triangles, std::span<const Box> boxes,
                             const EmbreeBuilder& builder) {
  if (triangles.size() <= kMostSplit) {
    if (Expected<BinaryTree> tree = builder.binary_tree(triangles)) {
      WideTree wide = TreeCollapse(*tree).wide_tree();
      if (depth_of(wide.root) <= kMaxTreeDepth) return wide;
    }
  }
  return builder.wide_tree(boxes, BVH_WIDTH);
}

/// A part of the hierarchy, over consecutive primitives of the tables.
struct Part {
  const TreeNode* root = nullptr;  ///< null: no tree
  Box box;
  LeafKind kind = kTriangleLeaf;
  int first = 0;  ///< index of the first primitive
};

struct NodeCount {
  std::size_t inner = 0, leaves = 0;
};
void add_count(const TreeNode* node, NodeCount& count) {
  if (node->child_count == 0) {
    ++count.leaves;
    return;
  }
  ++count.inner;
  const auto* inner = static_cast<const WideNode*>(node);
  for (int k = 0; k < inner->child_count; ++k) add_count(inner->children[k], count);
}

/// Reserves memory so that a large table is not moved as it grows, while many small additions stay cheap.
template <typename Record>
void reserve_more(std::vector<Record>& records, std::size_t more) {
  const std::size_t wanted = records.size() + more;
  if (wanted > records.capacity()) records.reserve(std::max(wanted, 2 * records.capacity()));
}

class Flattener {
 public:
  /// `triangles`: all of the scene. `empty_child`: a leaf that is there, for slots without a child.
  Flattener(Hierarchy& out, std::span<const Triangle> triangles, int empty_child)
      : out_(out), triangles_(triangles), empty_child_(empty_child) {}

  /// Appends a tree over the parts that have a root; without any, a node without children. Returns its root.
  int flatten(std::span<const Part> parts) {
    const Part* only = nullptr;
    int count = 0;
    for (const Part& part : parts) {
      if (part.root == nullptr) continue;
      only = &part;
      ++count;
    }
    if (count == 1 && only->root->child_count > 0) {
      reserve_for(parts);
      return emit(only->root, *only);
    }
    const int root = add_root();
    reserve_for(parts);
    int slot = 0;
    for (const Part& part : parts)
      if (part.root != nullptr) set_child(std::size_t(root), slot++, part.box, emit(part.root, part));
    return root;
  }

  /// Appends a node without children.
  int add_root() {
    out_.nodes.push_back(empty_node());
    return int(out_.nodes.size()) - 1;
  }

  /// Makes trees over the parts that have a root children of node 0, which has none yet. One slot stays free.
  /// A tree's root is replaced by its children as far as there are slots, so that a ray visits no more nodes
  /// than in a hierarchy of its own.
  void add_children(std::span<const Part> parts) {
    reserve_for(parts);
    std::vector<Subtree> trees;
    for (const Part& part : parts)
      if (part.root != nullptr) trees.push_back({part.root, part.box, &part});
    WideNode pair;
    if (trees.size() == 1 && trees[0].root->child_count == BVH_WIDTH)
      trees = with_joined_pair(trees[0], pair);
    else
      open_largest(trees);
    for (std::size_t k = 0; k < trees.size(); ++k)
      set_child(0, int(k), trees[k].box, emit(trees[k].root, *trees[k].part));
  }

  /// Makes a tree over the parts the last child of node 0, which has `slot` others. Does nothing without
  /// parts.
  void add_last_child(int slot, std::span<const Part> parts) {
    const BvhNode empty = empty_node();
    for (int k = slot; k < BVH_WIDTH; ++k) set_child(0, k, Box(), empty.child[k]);
    Box box;
    for (const Part& part : parts)
      if (part.root != nullptr) box.include(part.box);
    if (std::ranges::any_of(parts, [](const Part& part) { return part.root != nullptr; }))
      set_child(0, slot, box, flatten(parts));
  }

 private:
  struct Subtree {
    const TreeNode* root;
    Box box;
    const Part* part;
  };

  static std::vector<Subtree> children_of(const Subtree& tree) {
    const auto* inner = static_cast<const WideNode*>(tree.root);
    std::vector<Subtree> children;
    for (int k = 0; k < tree.root->child_count; ++k)
      children.push_back({inner->children[k], inner->bounds[k], tree.part});
    return children;
  }

  /// Replaces trees by their children, the one with the largest surface first, while there are slots.
  static void open_largest(std::vector<Subtree>& trees) {
    for (;;) {
      auto largest = trees.end();
      for (auto tree = trees.begin(); tree != trees.end(); ++tree)
        if (tree->root->child_count > 0 &&
            trees.size() - 1 + std::size_t(tree->root->child_count) < std::size_t(BVH_WIDTH) &&
            (largest == trees.end() || half_area(tree->box) > half_area(largest->box)))
          largest = tree;
      if (largest == trees.end()) return;
      const std::vector<Subtree> children = children_of(*largest);
      trees.insert(trees.erase(largest), children.begin(), children.end());
    }
  }

  /// The children of a node that is full, of which those two that have the least surface together become one.
  static std::vector<Subtree> with_joined_pair(const Subtree& tree, WideNode& pair) {
    std::vector<Subtree> children = children_of(tree);
    std::size_t first = 0, second = 1;
    const auto joined = [&](std::size_t i, std::size_t j) {
      Box box = children[i].box;
      box.include(children[j].box);
      return box;
    };
    for (std::size_t i = 0; i < children.size(); ++i)
      for (std::size_t j = i + 1; j < children.size(); ++j)
        if (half_area(joined(i, j)) < half_area(joined(first, second)))
          std::tie(first, second) = std::pair(i, j);
    pair.child_count = 2;
    for (const auto [slot, child] : {std::pair(0, first), std::pair(1, second)}) {
      pair.bounds[slot] = children[child].box;
      pair.children[slot] = children[child].root;
    }
    children[first] = {&pair, joined(first, second), tree.part};
    children.erase(children.begin() + std::ptrdiff_t(second));
    return children;
  }

  static void set_bounds_of_slot(BvhNode& node, int slot, const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
      node.bounds[axis][slot] = box.low[axis];
      node.bounds[axis + 3][slot] = box.high[axis];
    }
  }

  void reserve_for(std::span<const Part> parts) {
    NodeCount nodes;
    for (const Part& part : parts) {
      if (part.root == nullptr) continue;
      add_count(part.root, nodes);
      if (part.kind == kTriangleLeaf) reserve_more(out_.triangle_leaves, nodes.leaves);
    }
    reserve_more(out_.nodes, nodes.inner + 2);
  }

  [[nodiscard]] BvhNode empty_node() const {
    BvhNode node{};
    for (int k = 0; k < BVH_WIDTH; ++k) {
      set_bounds_of_slot(node, k, Box());
      node.child[k] = empty_child_;  // a ray with NaNs visits it
    }
    return node;
  }

  void set_child(std::size_t at, int slot, const Box& box, int child) {
    set_bounds_of_slot(out_.nodes[at], slot, box);
    out_.nodes[at].child[slot] = child;
  }

  int emit(const TreeNode* node, const Part& part) {
    if (node->child_count == 0) {
      switch (part.kind) {
        case kTriangleLeaf:
          return emit_triangles(static_cast<const WideLeaf&>(*node), part);
        case kQuadricLeaf:
          return emit_quadrics(static_cast<const WideLeaf&>(*node), part);
        default:
          return leaf_code(kInstanceLeaf,
                           std::size_t(part.first + static_cast<const WideLeaf*>(node)->primitives[0]));
      }
    }
    const std::size_t at = out_.nodes.size();
    out_.nodes.push_back(empty_node());
    const auto* inner = static_cast<const WideNode*>(node);
    for (int k = 0; k < inner->child_count; ++k)
      set_child(at, k, inner->bounds[k], emit(inner->children[k], part));
    return int(at);
  }

  int emit_triangles(const WideLeaf& node, const Part& part) {
    int primitives[BVH_WIDTH];
    for (int j = 0; j < BVH_WIDTH; ++j)
      primitives[j] = j < node.primitive_count ? part.first + node.primitives[j] : -1;
    out_.triangle_leaves.push_back(triangle_leaf(primitives, triangles_));
    return leaf_code(kTriangleLeaf, out_.triangle_leaves.size() - 1);
  }

  int emit_quadrics(const WideLeaf& node, const Part& part) {
    QuadricLeaf leaf{};
    for (int j = 0; j < BVH_WIDTH; ++j)
      leaf.primitive[j] = j < node.primitive_count ? part.first + node.primitives[j] : -1;
    out_.quadric_leaves.push_back(leaf);
    return leaf_code(kQuadricLeaf, out_.quadric_leaves.size() - 1);
  }

  Hierarchy& out_;
  const std::span<const Triangle> triangles_;
  const int empty_child_;
};

template <typename Primitive>
std::vector<Box> boxes_of(std::span<const Primitive> primitives, Box (*box_of)(const Primitive&)) {
  std::vector<Box> boxes;
  boxes.reserve(primitives.size());
  for (const Primitive& p : primitives) boxes.push_back(box_of(p));
  return boxes;
}

std::array<double, 3> axes(const vec3& v) { return {v.x, v.y, v.z}; }

/// The box of a placed group without margins, and the sums of what is rounded when it is computed.
struct PlacedBox {
  std::array<double, 3> low{}, high{}, rounded{};
};
PlacedBox placed_box(const Instance& instance, const Box& group) {
  const std::array<double, 3> columns[] = {axes(instance.x), axes(instance.y), axes(instance.z)};
  const std::array<double, 3> at = axes(instance.at);
  PlacedBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = box.high[k] = at[k];
    box.rounded[k] = std::abs(at[k]);
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = columns[i][k] * group.low[i], b = columns[i][k] * group.high[i];
      box.low[k] += std::min(a, b);
      box.high[k] += std::max(a, b);
      box.rounded[k] += std::max(std::abs(a), std::abs(b));
    }
  }
  return box;
}

std::vector<Box> group_boxes(const HierarchyInput& input) {
  std::vector<Box> boxes;
  boxes.reserve(input.groups.size());
  for (const PrimitiveGroup& group : input.groups)
    boxes.push_back(group_bounds(input.triangles, input.quadrics, group));
  return boxes;
}

/// How far the primitives of group 0 and the instances reach from the origin, summed over the axes. Where
/// something moves it is rounded up to a power of two, so that it seldom changes.
double extent_of(const HierarchyInput& input, std::span<const Box> groups) {
  std::array<double, 3> reach{};
  const Box& once = groups.front();
  for (std::size_t k = 0; k < 3 && once.low[0] <= once.high[0]; ++k)
    reach[k] = std::max(std::abs(once.low[k]), std::abs(once.high[k]));
  for (const Instance& instance : input.instances) {
    const PlacedBox box = placed_box(instance, groups[std::size_t(instance.group)]);
    for (std::size_t k = 0; k < 3; ++k)
      reach[k] = std::max({reach[k], std::abs(box.low[k]), std::abs(box.high[k])});
  }
  const double extent = reach[0] + reach[1] + reach[2];
  if (!input.still || !std::isfinite(extent)) return extent;
  int exponent = 0;
  std::frexp(extent, &exponent);
  return std::ldexp(1.0, exponent);
}

std::vector<Box> instance_bounds(std::span<const Instance> instances, std::span<const Box> groups,
                                 double extent) {
  std::vector<Box> boxes;
  boxes.reserve(instances.size());
  for (const Instance& instance : instances)
    boxes.push_back(placed_bounds(instance, groups[std::size_t(instance.group)], extent).box);
  return boxes;
}

/// Builds the trees of a hierarchy, one after the other.
class Builder {
 public:
  Builder(const HierarchyInput& input, const EmbreeBuilder& embree, Hierarchy& out)
      : in_(input), embree_(embree), out_(out), flattener_(out, input.triangles, empty_child(input)) {
    out_.roots.resize(in_.groups.size());
    if (in_.instances.empty()) return;
    // Instances need the bounds of groups, whose own trees are built after that of group 0.
    group_boxes_ = group_boxes(in_);
    extent_ = extent_of(in_, group_boxes_);
  }

  Expected<void> build_whole() {
    Range all = of_group(in_.groups[0]);
    all.instances = int(in_.instances.size());
    // The scene's own root must be node 0.
    Expected<Trees> trees = trees_over(all);
    if (!trees) return std::unexpected(trees.error());
    out_.roots[0] = flattener_.flatten(trees->parts);
    if (auto done = add_groups(1, in_.groups.size()); !done) return done;
    // Empty slots name a leaf.
    if (out_.triangle_leaves.empty() && out_.quadric_leaves.empty()) {
      constexpr int kNone[BVH_WIDTH] = {-1, -1, -1, -1, -1, -1, -1, -1};
      out_.triangle_leaves.push_back(triangle_leaf(kNone, in_.triangles));
    }
    return {};
  }

  /// The root, and below it all that is still.
  Expected<void> build_still() {
    const StillRecords& still = *in_.still;
    out_.roots[0] = flattener_.add_root();
    Expected<Trees> trees = trees_over(still_range());
    if (!trees) return std::unexpected(trees.error());
    flattener_.add_children(trees->parts);
    if (auto done = add_groups(1, std::size_t(still.groups)); !done) return done;
    out_.roots.resize(std::size_t(still.groups));
    out_.still = still_part(in_, out_);
    return {};
  }

  /// Adds what moves to a hierarchy with the root and all that is still.
  Expected<void> add_moving() {
    const Range still = still_range();
    Range all = of_group(in_.groups[0]);
    all.instances = int(in_.instances.size());
    const Range moving{still.first_triangle + still.triangles,
                       all.triangles - still.triangles,
                       still.first_quadric + still.quadrics,
                       all.quadrics - still.quadrics,
                       still.instances,
                       all.instances - still.instances};
    Expected<Trees> trees = trees_over(moving);
    if (!trees) return std::unexpected(trees.error());
    flattener_.add_last_child(out_.still.root_children, trees->parts);
    return add_groups(std::size_t(in_.still->groups), in_.groups.size());
  }

 private:
  /// Consecutive primitives and instances.
  struct Range {
    int first_triangle = 0, triangles = 0, first_quadric = 0, quadrics = 0, first_instance = 0, instances = 0;
  };
  struct Trees {
    WideTree trees[kLeafKinds];
    Part parts[kLeafKinds];
  };

  /// A leaf that is there; with still primitives one of theirs.
  static int empty_child(const HierarchyInput& input) {
    const bool still = input.still && input.still->triangles + input.still->quadrics > 0;
    const auto some = [&](int PrimitiveGroup::*count) {
      return std::ranges::any_of(input.groups, [&](const PrimitiveGroup& group) { return group.*count > 0; });
    };
    const bool triangles =
        still ? input.still->triangles > 0
              : some(&PrimitiveGroup::triangle_count) || !some(&PrimitiveGroup::quadric_count);
    return leaf_code(triangles ? kTriangleLeaf : kQuadricLeaf, 0);
  }

  static Range of_group(const PrimitiveGroup& group) {
    return {group.first_triangle, group.triangle_count, group.first_quadric, group.quadric_count};
  }

  [[nodiscard]] Range still_range() const {
    const PrimitiveGroup& own = in_.groups[0];
    const StillRecords& still = *in_.still;
    return {own.first_triangle,
            still.triangles - own.first_triangle,
            own.first_quadric,
            still.quadrics - own.first_quadric,
            0,
            still.instances};
  }

  [[nodiscard]] Expected<Trees> trees_over(const Range& range) const {
    Trees made;
    for (int kind = 0; kind < kLeafKinds; ++kind) made.parts[kind].kind = LeafKind(kind);
    const auto triangles =
        in_.triangles.subspan(std::size_t(range.first_triangle), std::size_t(range.triangles));
    const auto quadrics = in_.quadrics.subspan(std::size_t(range.first_quadric), std::size_t(range.quadrics));
    const auto instances =
        in_.instances.subspan(std::size_t(range.first_instance), std::size_t(range.instances));
    made.parts[kTriangleLeaf].first = range.first_triangle;
    made.parts[kQuadricLeaf].first = int(in_.triangles.size()) + range.first_quadric;
    made.parts[kInstanceLeaf].first = range.first_instance;
    std::vector<Box> boxes[kLeafKinds] = {
        boxes_of(triangles, hit_bounds), boxes_of(quadrics, penumbra::bounds_of), {}};
    if (!instances.empty()) boxes[kInstanceLeaf] = instance_bounds(instances, group_boxes_, extent_);
    for (Part& part : made.parts) {
      std::vector<Box>& its_boxes = boxes[part.kind];
      if (its_boxes.empty()) continue;
      for (const Box& box : its_boxes) part.box.include(box);
      Expected<WideTree> tree = part.kind == kTriangleLeaf  ? tree_over(triangles, its_boxes, embree_)
                                : part.kind == kQuadricLeaf ? embree_.wide_tree(its_boxes, BVH_WIDTH)
                                                            : embree_.wide_tree(its_boxes, 1);
      if (!tree) return std::unexpected(tree.error());
      std::vector<Box>().swap(its_boxes);
      made.trees[part.kind] = std::move(*tree);
      part.root = made.trees[part.kind].root;
    }
    return made;
  }

  Expected<void> add_groups(std::size_t from, std::size_t to) {
    for (std::size_t g = from; g < to; ++g) {
      Expected<Trees> trees = trees_over(of_group(in_.groups[g]));
      if (!trees) return std::unexpected(trees.error());
      out_.roots[g] = flattener_.flatten(trees->parts);
    }
    return {};
  }

  const HierarchyInput& in_;
  const EmbreeBuilder& embree_;
  Hierarchy& out_;
  Flattener flattener_;
  std::vector<Box> group_boxes_;
  double extent_ = 0;
};

Expected<EmbreeBuilder> start_embree(int threads) {
  return EmbreeBuilder::start(unsigned(threads > 0 ? std::size_t(threads) : core_count()));
}

}  // namespace

Box group_bounds(std::span<const Triangle> triangles, std::span<const Quadric> quadrics,
                 const PrimitiveGroup& group) {
  Box box;
  for (int i = 0; i < group.triangle_count; ++i)
    box.include(hit_bounds(triangles[std::size_t(group.first_triangle + i)]));
  for (int i = 0; i < group.quadric_count; ++i)
    box.include(bounds_of(quadrics[std::size_t(group.first_quadric + i)]));
  return box;
}

/// About 5 rounding errors of the products in either direction; see from_group_extent.
PlacedBounds placed_bounds(const Instance& instance, const Box& group, double extent) {
  constexpr double kRoundings = 16 * HALF_EPSILON;
  const PlacedBox placed = placed_box(instance, group);
  const std::array<double, 3> columns[] = {axes(instance.x), axes(instance.y), axes(instance.z)};
  const std::array<double, 3> rows[] = {axes(instance.row_x), axes(instance.row_y), axes(instance.row_z)};
  PlacedBounds bounds;
  for (std::size_t k = 0; k < 3; ++k) {
    // By what transforming back and forth amplifies rounding errors.
    double stretch = 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        stretch = std::max(stretch, 3 * std::abs(columns[i][k]) * std::abs(rows[i][j]));
    const double margin = kRoundings * stretch * extent;
    bounds.box.low[k] = float(float(placed.low[k] - kRoundings * placed.rounded[k]) - margin);
    bounds.box.high[k] = float(float(placed.high[k] + kRoundings * placed.rounded[k]) + margin);
    bounds.margin = std::max(bounds.margin, margin);
  }
  return bounds;
}

TriangleLeaf triangle_leaf(std::span<const int, BVH_WIDTH> primitives, std::span<const Triangle> triangles) {
  TriangleLeaf leaf{};
  for (int j = 0; j < BVH_WIDTH; ++j) {
    leaf.primitive[j] = primitives[std::size_t(j)];
    if (leaf.primitive[j] < 0) continue;
    const Triangle& t = triangles[std::size_t(leaf.primitive[j])];
    const vec3 p[3] = {t.p0, t.p1, t.p2};
    for (int v = 0; v < 3; ++v) {
      leaf.p[v][0][j] = p[v].x;
      leaf.p[v][1][j] = p[v].y;
      leaf.p[v][2][j] = p[v].z;
    }
  }
  return leaf;
}

Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics) {
  const PrimitiveGroup all{0, 0, int(triangles.size()), 0, int(quadrics.size())};
  return build_hierarchy(triangles, quadrics, std::span(&all, 1), {});
}

Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics,
                                    std::span<const PrimitiveGroup> groups,
                                    std::span<const Instance> instances, int threads) {
  return build_hierarchy({triangles, quadrics, groups, instances}, threads);
}

Expected<Hierarchy> build_hierarchy(const HierarchyInput& input, int threads) {
  if (input.still) {
    Expected<Hierarchy> hierarchy = build_still(input, threads);
    if (!hierarchy) return hierarchy;
    if (Expected<void> done = add_moving(input, *hierarchy, threads); !done)
      return std::unexpected(done.error());
    return hierarchy;
  }
  const Expected<EmbreeBuilder> embree = start_embree(threads);
  if (!embree) return std::unexpected(embree.error());
  Hierarchy hierarchy;
  if (Expected<void> done = Builder(input, *embree, hierarchy).build_whole(); !done)
    return std::unexpected(done.error());
  return hierarchy;
}

Expected<Hierarchy> build_still(const HierarchyInput& input, int threads) {
  const Expected<EmbreeBuilder> embree = start_embree(threads);
  if (!embree) return std::unexpected(embree.error());
  Hierarchy hierarchy;
  if (Expected<void> done = Builder(input, *embree, hierarchy).build_still(); !done)
    return std::unexpected(done.error());
  return hierarchy;
}

Expected<void> add_moving(const HierarchyInput& input, Hierarchy& hierarchy, int threads) {
  const Expected<EmbreeBuilder> embree = start_embree(threads);
  if (!embree) return std::unexpected(embree.error());
  return Builder(input, *embree, hierarchy).add_moving();
}

StillRecords still_part(const HierarchyInput& input, const Hierarchy& hierarchy) {
  StillRecords still = *input.still;
  still.nodes = int(hierarchy.nodes.size());
  still.triangle_leaves = int(hierarchy.triangle_leaves.size());
  still.quadric_leaves = int(hierarchy.quadric_leaves.size());
  for (int k = 0; k < BVH_WIDTH; ++k)
    still.root_children += hierarchy.nodes[0].bounds[0][k] <= hierarchy.nodes[0].bounds[3][k] ? 1 : 0;
  still.extent = hierarchy_extent(input);
  return still;
}

double hierarchy_extent(const HierarchyInput& input) {
  return input.instances.empty() ? 0 : extent_of(input, group_boxes(input));
}

}  // namespace penumbra
