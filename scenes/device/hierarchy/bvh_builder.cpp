#include "scenes/device/hierarchy/bvh_builder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/host/bounds.h"
#include "kernels/host/parallel.h"
#include "kernels/math/math.h"
#include "scenes/device/hierarchy/embree_builder.h"
#include "scenes/device/hierarchy/tree_collapse.h"

namespace penumbra {
namespace {

/// The kinds of leaves. Until the number of leaves of each kind is known, a child is stored as the code of a
/// leaf.
enum LeafKind { kTriangleLeaf, kQuadricLeaf, kInstanceLeaf, kLeafKinds };
constexpr int kCodeBits = 29;
int leaf_code(LeafKind kind, std::size_t index) { return ~(int(kind) << kCodeBits | int(index)); }

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
  /// `triangles`: all of the scene.
  Flattener(Hierarchy& out, std::span<const Triangle> triangles) : out_(out), triangles_(triangles) {}

  /// Appends a tree over the parts that have a root, of which there must be one. Returns its root.
  int flatten(std::span<const Part> parts) {
    const Part* only = nullptr;
    int count = 0;
    NodeCount nodes;
    for (const Part& part : parts) {
      if (part.root == nullptr) continue;
      only = &part;
      ++count;
      add_count(part.root, nodes);
      if (part.kind == kTriangleLeaf) reserve_more(out_.triangle_leaves, nodes.leaves);
    }
    reserve_more(out_.nodes, nodes.inner + 1);
    if (count == 1 && only->root->child_count > 0) return emit(only->root, *only);
    const std::size_t at = out_.nodes.size();
    out_.nodes.push_back(empty_node());
    int slot = 0;
    for (const Part& part : parts)
      if (part.root != nullptr) set_child(at, slot++, part.box, emit(part.root, part));
    return int(at);
  }

  /// Replaces codes by indices: first the triangle leaves, then the quadric leaves.
  void number_leaves() {
    const int first[kLeafKinds] = {0, int(out_.triangle_leaves.size()),
                                   int(out_.triangle_leaves.size() + out_.quadric_leaves.size())};
    for (BvhNode& node : out_.nodes)
      for (int& child : node.child) {
        const int code = ~child;
        if (child < 0) child = ~(first[code >> kCodeBits] + (code & ((1 << kCodeBits) - 1)));
      }
  }

 private:
  static void set_bounds_of_slot(BvhNode& node, int slot, const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
      node.bounds[axis][slot] = box.low[axis];
      node.bounds[axis + 3][slot] = box.high[axis];
    }
  }

  static BvhNode empty_node() {
    BvhNode node{};
    for (int k = 0; k < BVH_WIDTH; ++k) {
      set_bounds_of_slot(node, k, Box());
      node.child[k] = ~0;  // a leaf, in case a ray with NaNs visits it
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
          return leaf_code(kInstanceLeaf, std::size_t(static_cast<const WideLeaf*>(node)->primitives[0]));
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
};

template <typename Primitive>
std::vector<Box> boxes_of(std::span<const Primitive> primitives, Box (*box_of)(const Primitive&)) {
  std::vector<Box> boxes;
  boxes.reserve(primitives.size());
  for (const Primitive& p : primitives) boxes.push_back(box_of(p));
  return boxes;
}

Box bounds_of(std::span<const Triangle> triangles, std::span<const Quadric> quadrics,
              const PrimitiveGroup& group) {
  Box box;
  for (int i = 0; i < group.triangle_count; ++i)
    box.include(hit_bounds(triangles[std::size_t(group.first_triangle + i)]));
  for (int i = 0; i < group.quadric_count; ++i)
    box.include(bounds_of(quadrics[std::size_t(group.first_quadric + i)]));
  return box;
}

/// Bounds of the placed groups, enlarged by the rounding errors of rays that enter a group from anywhere in
/// the scene: about 5 rounding errors of the products in either direction; see from_group_extent.
std::vector<Box> instance_bounds(std::span<const Instance> instances, std::span<const Box> groups) {
  constexpr double kRoundings = 16 * HALF_EPSILON;
  const auto axes = [](const vec3& v) { return std::array<double, 3>{v.x, v.y, v.z}; };
  std::vector<Box> boxes;
  boxes.reserve(instances.size());
  // Factors by which transforming back and forth amplifies rounding errors.
  std::vector<std::array<double, 3>> stretches;
  std::array<double, 3> reach{};  // extent of the scene from its centre
  const Box& once = groups.front();
  for (std::size_t k = 0; k < 3 && once.low[0] <= once.high[0]; ++k)
    reach[k] = std::max(std::abs(once.low[k]), std::abs(once.high[k]));
  for (const Instance& instance : instances) {
    const Box& group = groups[std::size_t(instance.group)];
    const std::array<double, 3> columns[] = {axes(instance.x), axes(instance.y), axes(instance.z)};
    const std::array<double, 3> rows[] = {axes(instance.row_x), axes(instance.row_y), axes(instance.row_z)};
    const std::array<double, 3> at = axes(instance.at);
    Box box;
    std::array<double, 3> stretch{};
    for (std::size_t k = 0; k < 3; ++k) {
      double low = at[k], high = at[k], rounding = std::abs(at[k]);
      for (std::size_t i = 0; i < 3; ++i) {
        const double a = columns[i][k] * group.low[i], b = columns[i][k] * group.high[i];
        low += std::min(a, b);
        high += std::max(a, b);
        rounding += std::max(std::abs(a), std::abs(b));
        for (std::size_t j = 0; j < 3; ++j)
          stretch[k] = std::max(stretch[k], 3 * std::abs(columns[i][k]) * std::abs(rows[i][j]));
      }
      box.low[k] = float(low - kRoundings * rounding);
      box.high[k] = float(high + kRoundings * rounding);
      reach[k] = std::max({reach[k], std::abs(low), std::abs(high)});
    }
    boxes.push_back(box);
    stretches.push_back(stretch);
  }
  const double farthest = reach[0] + reach[1] + reach[2];
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double margin = kRoundings * stretches[i][k] * farthest;
      boxes[i].low[k] = float(boxes[i].low[k] - margin);
      boxes[i].high[k] = float(boxes[i].high[k] + margin);
    }
  return boxes;
}

}  // namespace

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
  const unsigned wanted = unsigned(threads > 0 ? std::size_t(threads) : core_count());
  const Expected<EmbreeBuilder> builder = EmbreeBuilder::start(wanted);
  if (!builder) return std::unexpected(builder.error());
  Hierarchy hierarchy;
  Flattener flattener(hierarchy, triangles);
  hierarchy.roots.resize(groups.size());
  std::vector<Box> group_boxes(groups.size());
  std::vector<Box> placed;
  const auto add = [&](std::size_t g) -> Expected<void> {
    const PrimitiveGroup& group = groups[g];
    WideTree trees[kLeafKinds];
    Part parts[kLeafKinds];
    for (int kind = 0; kind < kLeafKinds; ++kind) parts[kind].kind = LeafKind(kind);
    const auto its_triangles =
        triangles.subspan(std::size_t(group.first_triangle), std::size_t(group.triangle_count));
    parts[kTriangleLeaf].first = group.first_triangle;
    parts[kQuadricLeaf].first = int(triangles.size()) + group.first_quadric;
    const auto its_quadrics =
        quadrics.subspan(std::size_t(group.first_quadric), std::size_t(group.quadric_count));
    std::vector<Box> boxes[kLeafKinds] = {boxes_of(its_triangles, hit_bounds),
                                          boxes_of(its_quadrics, bounds_of),
                                          g == 0 ? std::move(placed) : std::vector<Box>()};
    for (Part& part : parts) {
      std::vector<Box>& its_boxes = boxes[part.kind];
      if (its_boxes.empty()) continue;
      for (const Box& box : its_boxes) part.box.include(box);
      Expected<WideTree> tree = part.kind == kTriangleLeaf  ? tree_over(its_triangles, its_boxes, *builder)
                                : part.kind == kQuadricLeaf ? builder->wide_tree(its_boxes, BVH_WIDTH)
                                                            : builder->wide_tree(its_boxes, 1);
      if (!tree) return std::unexpected(tree.error());
      std::vector<Box>().swap(its_boxes);
      trees[part.kind] = std::move(*tree);
      part.root = trees[part.kind].root;
    }
    hierarchy.roots[g] = flattener.flatten(parts);
    return {};
  };
  // The scene's own root must be node 0, so it is built first. It needs the bounds of instances before the
  // groups' trees are built.
  for (std::size_t g = 0; g < groups.size() && !instances.empty(); ++g)
    group_boxes[g] = bounds_of(triangles, quadrics, groups[g]);
  placed = instance_bounds(instances, group_boxes);
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (auto done = add(g); !done) return std::unexpected(done.error());
  flattener.number_leaves();
  return hierarchy;
}

}  // namespace penumbra
