#include "scenes/device/bvh_builder.h"

#include <embree3/rtcore.h>

#include <deque>
#include <memory>

#include "kernels/host/bounds.h"
#include "kernels/intersect/bvh_limits.h"
#include "scenes/device/triangle_split.h"

namespace penumbra {
namespace {

/// What Embree's builder hands back, before it is flattened.
struct BuildNode {
  Box bounds[BVH_WIDTH];
  BuildNode* children[BVH_WIDTH];
  int child_count = 0;
  std::vector<int> primitives;  ///< a leaf's
};

using NodePool = std::deque<BuildNode>;  // stable addresses; the build runs on one thread

/// What the builder's calls back work on.
struct Build {
  NodePool& nodes;
  std::span<const Triangle> triangles;  ///< the primitives, if they are triangles
};

BuildNode* new_node(void* build) { return &static_cast<Build*>(build)->nodes.emplace_back(); }

void* create_node(RTCThreadLocalAllocator, unsigned count, void* build) {
  BuildNode* node = new_node(build);
  node->child_count = int(count);
  return node;
}

void set_children(void* node, void** children, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i)
    static_cast<BuildNode*>(node)->children[i] = static_cast<BuildNode*>(children[i]);
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) {
    const RTCBounds& b = *bounds[i];
    Box& box = static_cast<BuildNode*>(node)->bounds[i];
    box.include(make_vec3(b.lower_x, b.lower_y, b.lower_z));
    box.include(make_vec3(b.upper_x, b.upper_y, b.upper_z));
  }
}

void* create_leaf(RTCThreadLocalAllocator, const RTCBuildPrimitive* primitives, size_t count, void* build) {
  BuildNode* node = new_node(build);
  for (size_t i = 0; i < count; ++i) node->primitives.push_back(int(primitives[i].primID));
  return node;
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

/// Triangles are split where that pays, into up to half as many parts again: bounced rays are 8 % (classroom)
/// and 34 % (spaceship) faster.
constexpr double kRoomForParts = 1.5;

Expected<BuildNode*> build_tree(RTCDevice device, const std::vector<Box>& boxes, Build build) {
  const bool splits = !build.triangles.empty();
  std::vector<RTCBuildPrimitive> primitives(splits ? std::size_t(double(boxes.size()) * kRoomForParts)
                                                   : boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Box& b = boxes[i];
    primitives[i] = {b.low[0], b.low[1], b.low[2], 0, b.high[0], b.high[1], b.high[2], unsigned(i)};
  }
  BvhHandle bvh(rtcNewBVH(device));
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.byteSize = sizeof arguments;
  arguments.buildQuality = splits ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = BVH_WIDTH;
  arguments.maxDepth = BVH_MAX_DEPTH - 2;  // the root over both kinds of primitive and a margin
  arguments.sahBlockSize = BVH_WIDTH;
  arguments.minLeafSize = BVH_WIDTH;  // testing a full leaf costs as much as testing a node
  arguments.maxLeafSize = BVH_WIDTH;
  arguments.traversalCost = 1;
  arguments.intersectionCost = 1;
  arguments.bvh = bvh.get();
  arguments.primitives = primitives.data();
  arguments.primitiveCount = boxes.size();
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  arguments.splitPrimitive = splits ? split : nullptr;
  arguments.userPtr = &build;
  auto* root = static_cast<BuildNode*>(rtcBuildBVH(&arguments));
  if (!root)
    return fail("Embree could not build a hierarchy over " + std::to_string(boxes.size()) + " primitives");
  return root;
}

class Flattener {
 public:
  Flattener(std::span<const Triangle> triangles, Hierarchy& out) : triangles_(triangles), out_(out) {}

  /// Leaves get final numbers only when all triangle leaves are known, so quadric leaves are numbered from
  /// the other end of the negative range first.
  void flatten(const BuildNode* triangle_root, Box triangle_box, const BuildNode* quadric_root,
               Box quadric_box) {
    const BuildNode* only = triangle_root && quadric_root ? nullptr
                            : triangle_root               ? triangle_root
                                                          : quadric_root;
    if (only && only->child_count > 0) {
      emit(only, only == quadric_root);
      return;
    }
    out_.nodes.push_back(empty_node());
    int slot = 0;
    if (triangle_root) set_child(0, slot++, triangle_box, emit(triangle_root, false));
    const std::size_t quadric_nodes = out_.nodes.size();
    if (quadric_root) set_child(0, slot, quadric_box, emit(quadric_root, true));
    const int shift = int(out_.triangle_leaves.size());
    if (quadric_root && out_.nodes[0].child[slot] < 0) out_.nodes[0].child[slot] -= shift;
    for (std::size_t i = quadric_nodes; i < out_.nodes.size(); ++i)
      for (int& child : out_.nodes[i].child)
        if (child < 0) child -= shift;
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

  int emit(const BuildNode* node, bool quadrics) {
    if (node->child_count == 0) return quadrics ? emit_quadrics(*node) : emit_triangles(*node);
    const std::size_t at = out_.nodes.size();
    out_.nodes.push_back(empty_node());
    for (int k = 0; k < node->child_count; ++k)
      set_child(at, k, node->bounds[k], emit(node->children[k], quadrics));
    return int(at);
  }

  int emit_triangles(const BuildNode& node) {
    TriangleLeaf leaf{};
    for (int j = 0; j < BVH_WIDTH; ++j) {
      leaf.primitive[j] = -1;
      if (j >= int(node.primitives.size())) continue;
      leaf.primitive[j] = node.primitives[std::size_t(j)];
      const Triangle& t = triangles_[std::size_t(leaf.primitive[j])];
      const vec3 p[3] = {t.p0, t.p1, t.p2};
      for (int v = 0; v < 3; ++v) {
        leaf.p[v][0][j] = p[v].x;
        leaf.p[v][1][j] = p[v].y;
        leaf.p[v][2][j] = p[v].z;
      }
    }
    out_.triangle_leaves.push_back(leaf);
    return ~int(out_.triangle_leaves.size() - 1);
  }

  int emit_quadrics(const BuildNode& node) {
    QuadricLeaf leaf{};
    for (int j = 0; j < BVH_WIDTH; ++j)
      leaf.primitive[j] =
          j < int(node.primitives.size()) ? node.primitives[std::size_t(j)] + int(triangles_.size()) : -1;
    out_.quadric_leaves.push_back(leaf);
    return ~int(out_.quadric_leaves.size() - 1);
  }

  std::span<const Triangle> triangles_;
  Hierarchy& out_;
};

template <typename Primitive>
std::vector<Box> all_bounds(std::span<const Primitive> primitives, Box& total) {
  std::vector<Box> boxes;
  boxes.reserve(primitives.size());
  for (const Primitive& p : primitives) {
    boxes.push_back(bounds_of(p));
    total.include(boxes.back());
  }
  return boxes;
}

}  // namespace

Expected<Hierarchy> build_hierarchy(std::span<const Triangle> triangles, std::span<const Quadric> quadrics) {
  DeviceHandle device(rtcNewDevice("threads=1,isa=sse2"));
  if (!device) return fail("Embree does not start on this machine");
  Box triangle_box, quadric_box;
  const std::vector<Box> triangle_boxes = all_bounds(triangles, triangle_box);
  const std::vector<Box> quadric_boxes = all_bounds(quadrics, quadric_box);
  NodePool pool;
  BuildNode *triangle_root = nullptr, *quadric_root = nullptr;
  if (!triangles.empty()) {
    Expected<BuildNode*> root = build_tree(device.get(), triangle_boxes, {pool, triangles});
    if (!root) return std::unexpected(root.error());
    triangle_root = *root;
  }
  if (!quadrics.empty()) {
    Expected<BuildNode*> root = build_tree(device.get(), quadric_boxes, {pool, {}});
    if (!root) return std::unexpected(root.error());
    quadric_root = *root;
  }
  Hierarchy hierarchy;
  Flattener(triangles, hierarchy).flatten(triangle_root, triangle_box, quadric_root, quadric_box);
  return hierarchy;
}

}  // namespace penumbra
