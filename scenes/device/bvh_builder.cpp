#include "scenes/device/bvh_builder.h"

#include <embree3/rtcore.h>

#include <array>
#include <cmath>
#include <memory>
#include <new>
#include <string>
#include <thread>

#include "kernels/host/bounds.h"
#include "kernels/intersect/bvh_limits.h"
#include "kernels/math/math.h"
#include "scenes/device/triangle_split.h"

namespace penumbra {
namespace {

/// What Embree's builder hands back, before it is flattened: in memory of the builder's, which its threads
/// get without waiting for each other.
struct BuildNode {
  int child_count;  ///< 0: it is a leaf
};
struct InnerNode : BuildNode {
  Box bounds[BVH_WIDTH];
  BuildNode* children[BVH_WIDTH];
};
struct LeafNode : BuildNode {
  int primitive_count;
  int primitives[BVH_WIDTH];
};

/// What the builder's calls back work on.
struct Build {
  std::span<const Triangle> triangles;  ///< the primitives, if they are triangles
};

template <typename Node>
Node* new_node(RTCThreadLocalAllocator allocator) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(Node), 16)) Node{};
}

void* create_node(RTCThreadLocalAllocator allocator, unsigned count, void*) {
  auto* node = new_node<InnerNode>(allocator);
  node->child_count = int(count);
  return static_cast<BuildNode*>(node);
}

void set_children(void* to, void** children, unsigned count, void*) {
  auto* node = static_cast<InnerNode*>(static_cast<BuildNode*>(to));
  for (unsigned i = 0; i < count; ++i) node->children[i] = static_cast<BuildNode*>(children[i]);
}

void set_bounds(void* to, const RTCBounds** bounds, unsigned count, void*) {
  auto* node = static_cast<InnerNode*>(static_cast<BuildNode*>(to));
  for (unsigned i = 0; i < count; ++i) {
    const RTCBounds& b = *bounds[i];
    node->bounds[i].include(make_vec3(b.lower_x, b.lower_y, b.lower_z));
    node->bounds[i].include(make_vec3(b.upper_x, b.upper_y, b.upper_z));
  }
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, size_t count,
                  void*) {
  auto* leaf = new_node<LeafNode>(allocator);
  leaf->primitive_count = int(std::min<size_t>(count, BVH_WIDTH));
  for (int i = 0; i < leaf->primitive_count; ++i) leaf->primitives[i] = int(primitives[i].primID);
  return static_cast<BuildNode*>(leaf);
}

RTCBounds to_bounds(const Box& b) {
  return {b.low[0], b.low[1], b.low[2], 0, b.high[0], b.high[1], b.high[2], 0};
}

void split(const RTCBuildPrimitive* part, unsigned axis, float position, RTCBounds* below, RTCBounds* above,
           void* build) {
  Box bounds;
  bounds.include(make_vec3(part->lower_x, part->lower_y, part->lower_z));
  bounds.include(make_vec3(part->upper_x, part->upper_y, part->upper_z));
  const Triangle& triangle = static_cast<Build*>(build)->triangles[part->primID];
  const auto [low, high] = split_bounds(triangle, bounds, int(axis), position);
  *below = to_bounds(low);
  *above = to_bounds(high);
}

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
using DeviceHandle = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
struct BvhRelease {
  void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
};
using BvhHandle = std::unique_ptr<RTCBVHTy, BvhRelease>;

/// What a leaf holds. Until the numbers of leaves of each kind are known a child is the code of a leaf.
enum LeafKind { kTriangleLeaf, kQuadricLeaf, kInstanceLeaf, kLeafKinds };
constexpr int kCodeBits = 29;
int leaf_code(LeafKind kind, std::size_t index) { return ~(int(kind) << kCodeBits | int(index)); }

/// Triangles are split where that pays, into up to half as many parts again: bounced rays are 8 % (classroom)
/// and 34 % (spaceship) faster. That takes three times as long, so not where there are very many.
constexpr double kRoomForParts = 1.5;
constexpr std::size_t kMostSplit = 1'000'000;

/// The primitives are left in some other order.
Expected<BuildNode*> build_tree(RTCBVH bvh, std::vector<RTCBuildPrimitive>& primitives, LeafKind kind,
                                Build build) {
  const unsigned in_leaf = kind == kInstanceLeaf ? 1 : BVH_WIDTH;
  const bool splits = !build.triangles.empty() && build.triangles.size() <= kMostSplit;
  const std::size_t count = primitives.size();
  if (splits) primitives.resize(std::size_t(double(count) * kRoomForParts));
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.byteSize = sizeof arguments;
  arguments.buildQuality = splits ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = BVH_WIDTH;
  arguments.maxDepth = BVH_MAX_DEPTH - 2;  // the root over both kinds of primitive and a margin
  arguments.sahBlockSize = BVH_WIDTH;
  arguments.minLeafSize = in_leaf;  // testing a full leaf costs as much as testing a node
  arguments.maxLeafSize = in_leaf;
  arguments.traversalCost = 1;
  arguments.intersectionCost = 1;
  arguments.bvh = bvh;
  arguments.primitives = primitives.data();
  arguments.primitiveCount = count;
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  arguments.splitPrimitive = splits ? split : nullptr;
  arguments.userPtr = &build;
  auto* root = static_cast<BuildNode*>(rtcBuildBVH(&arguments));
  if (!root) return fail("Embree could not build a hierarchy over " + std::to_string(count) + " primitives");
  return root;
}

/// A part of the hierarchy: its primitives are consecutive ones of the tables.
struct Part {
  BuildNode* root = nullptr;  ///< null: none
  Box box;
  LeafKind kind = kTriangleLeaf;
  std::span<const Triangle> triangles;  ///< of leaves of triangles
  int first = 0;                        ///< number of the first primitive
};

struct NodeCount {
  std::size_t inner = 0, leaves = 0;
};
void add_count(const BuildNode* node, NodeCount& count) {
  if (node->child_count == 0) {
    ++count.leaves;
    return;
  }
  ++count.inner;
  const auto* inner = static_cast<const InnerNode*>(node);
  for (int k = 0; k < inner->child_count; ++k) add_count(inner->children[k], count);
}

/// So that large tables are not moved as they grow, nor many small ones each by a little.
template <typename Record>
void reserve_more(std::vector<Record>& records, std::size_t more) {
  const std::size_t wanted = records.size() + more;
  if (wanted > records.capacity()) records.reserve(std::max(wanted, 2 * records.capacity()));
}

class Flattener {
 public:
  explicit Flattener(Hierarchy& out) : out_(out) {}

  /// Appends a tree over the parts that have a root; at least one has. Returns its root.
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

  /// Replaces codes by numbers: those of triangle leaves come first, then those of quadric leaves.
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

  int emit(const BuildNode* node, const Part& part) {
    if (node->child_count == 0) {
      switch (part.kind) {
        case kTriangleLeaf:
          return emit_triangles(static_cast<const LeafNode&>(*node), part);
        case kQuadricLeaf:
          return emit_quadrics(static_cast<const LeafNode&>(*node), part);
        default:
          return leaf_code(kInstanceLeaf, std::size_t(static_cast<const LeafNode*>(node)->primitives[0]));
      }
    }
    const std::size_t at = out_.nodes.size();
    out_.nodes.push_back(empty_node());
    const auto* inner = static_cast<const InnerNode*>(node);
    for (int k = 0; k < inner->child_count; ++k)
      set_child(at, k, inner->bounds[k], emit(inner->children[k], part));
    return int(at);
  }

  int emit_triangles(const LeafNode& node, const Part& part) {
    TriangleLeaf leaf{};
    for (int j = 0; j < BVH_WIDTH; ++j) {
      leaf.primitive[j] = -1;
      if (j >= node.primitive_count) continue;
      const int index = node.primitives[j];
      leaf.primitive[j] = part.first + index;
      const Triangle& t = part.triangles[std::size_t(index)];
      const vec3 p[3] = {t.p0, t.p1, t.p2};
      for (int v = 0; v < 3; ++v) {
        leaf.p[v][0][j] = p[v].x;
        leaf.p[v][1][j] = p[v].y;
        leaf.p[v][2][j] = p[v].z;
      }
    }
    out_.triangle_leaves.push_back(leaf);
    return leaf_code(kTriangleLeaf, out_.triangle_leaves.size() - 1);
  }

  int emit_quadrics(const LeafNode& node, const Part& part) {
    QuadricLeaf leaf{};
    for (int j = 0; j < BVH_WIDTH; ++j)
      leaf.primitive[j] = j < node.primitive_count ? part.first + node.primitives[j] : -1;
    out_.quadric_leaves.push_back(leaf);
    return leaf_code(kQuadricLeaf, out_.quadric_leaves.size() - 1);
  }

  Hierarchy& out_;
};

const Box& bounds_of(const Box& box) { return box; }

/// What the builder takes, each by its number, and the box about all.
template <typename Primitives>
std::vector<RTCBuildPrimitive> build_primitives(const Primitives& primitives, Box& total) {
  std::vector<RTCBuildPrimitive> all;
  all.reserve(primitives.size());
  for (const auto& p : primitives) {
    const Box b = bounds_of(p);
    all.push_back({b.low[0], b.low[1], b.low[2], 0, b.high[0], b.high[1], b.high[2], unsigned(all.size())});
    total.include(b);
  }
  return all;
}

Box bounds_of(std::span<const Triangle> triangles, std::span<const Quadric> quadrics,
              const PrimitiveGroup& group) {
  Box box;
  for (int i = 0; i < group.triangle_count; ++i)
    box.include(bounds_of(triangles[std::size_t(group.first_triangle + i)]));
  for (int i = 0; i < group.quadric_count; ++i)
    box.include(bounds_of(quadrics[std::size_t(group.first_quadric + i)]));
  return box;
}

/// Of what is placed, and of the roundings of rays on their way into a group from anywhere in the scene: some
/// 5 of either way's products, see from_group_extent.
std::vector<Box> instance_bounds(std::span<const Instance> instances, std::span<const Box> groups) {
  constexpr double kRoundings = 16 * HALF_EPSILON;
  const auto axes = [](const vec3& v) { return std::array<double, 3>{v.x, v.y, v.z}; };
  std::vector<Box> boxes;
  boxes.reserve(instances.size());
  std::vector<std::array<double, 3>> stretches;  // by which a transform's way there and back grows roundings
  std::array<double, 3> reach{};                 // of the scene from its centre
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

Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics) {
  const PrimitiveGroup all{0, 0, int(triangles.size()), 0, int(quadrics.size())};
  return build_hierarchy(triangles, quadrics, std::span(&all, 1), {});
}

Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics,
                                    std::span<const PrimitiveGroup> groups,
                                    std::span<const Instance> instances, int threads) {
  const unsigned wanted = threads > 0 ? unsigned(threads) : std::max(1u, std::thread::hardware_concurrency());
  // The tree is the same whatever the number of threads.
  DeviceHandle device(rtcNewDevice(("isa=sse2,threads=" + std::to_string(wanted)).c_str()));
  if (!device) return fail("Embree does not start on this machine");
  Hierarchy hierarchy;
  Flattener flattener(hierarchy);
  hierarchy.roots.resize(groups.size());
  std::vector<Box> group_boxes(groups.size());
  std::vector<Box> placed;
  const auto add = [&](std::size_t g) -> Expected<void> {
    const PrimitiveGroup& group = groups[g];
    BvhHandle trees[kLeafKinds];  // whose memory the parts are in
    Part parts[kLeafKinds];
    for (int kind = 0; kind < kLeafKinds; ++kind) parts[kind].kind = LeafKind(kind);
    parts[kTriangleLeaf].triangles =
        triangles.subspan(std::size_t(group.first_triangle), std::size_t(group.triangle_count));
    parts[kTriangleLeaf].first = group.first_triangle;
    parts[kQuadricLeaf].first = int(triangles.size()) + group.first_quadric;
    const auto its_quadrics =
        quadrics.subspan(std::size_t(group.first_quadric), std::size_t(group.quadric_count));
    std::vector<RTCBuildPrimitive> primitives[kLeafKinds] = {
        build_primitives(parts[kTriangleLeaf].triangles, parts[kTriangleLeaf].box),
        build_primitives(its_quadrics, parts[kQuadricLeaf].box),
        build_primitives(g == 0 ? std::move(placed) : std::vector<Box>(), parts[kInstanceLeaf].box)};
    for (Part& part : parts) {
      if (primitives[part.kind].empty()) continue;
      trees[part.kind].reset(rtcNewBVH(device.get()));
      Expected<BuildNode*> root =
          build_tree(trees[part.kind].get(), primitives[part.kind], part.kind, {part.triangles});
      if (!root) return std::unexpected(root.error());
      std::vector<RTCBuildPrimitive>().swap(primitives[part.kind]);
      part.root = *root;
    }
    hierarchy.roots[g] = flattener.flatten(parts);
    return {};
  };
  // The scene's own root is node 0, so it comes first; its instances' bounds are known before their trees
  // are.
  for (std::size_t g = 0; g < groups.size() && !instances.empty(); ++g)
    group_boxes[g] = bounds_of(triangles, quadrics, groups[g]);
  placed = instance_bounds(instances, group_boxes);
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (auto done = add(g); !done) return std::unexpected(done.error());
  flattener.number_leaves();
  return hierarchy;
}

}  // namespace penumbra
