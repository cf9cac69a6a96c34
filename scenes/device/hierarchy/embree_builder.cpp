#include "scenes/device/hierarchy/embree_builder.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <new>
#include <string>
#include <vector>

#include "scenes/device/hierarchy/triangle_split.h"

namespace penumbra {
namespace {

constexpr double kRoomForParts = 1.5;
/// Binary trees are deeper than the wide trees made from them, whose depth is checked later.
constexpr unsigned kMaxBinaryDepth = 200;

struct BvhRelease {
  void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
};
using BvhHandle = std::unique_ptr<RTCBVHTy, BvhRelease>;

/// Allocates a node from the builder thread's own memory, without locks.
template <typename Node>
Node* new_node(RTCThreadLocalAllocator allocator) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(Node), 16)) Node{};
}

template <typename Node>
void* create_node(RTCThreadLocalAllocator allocator, unsigned count, void*) {
  auto* node = new_node<Node>(allocator);
  node->child_count = int(count);
  return static_cast<TreeNode*>(node);
}

template <typename Node>
void set_children(void* to, void** children, unsigned count, void*) {
  auto* node = static_cast<Node*>(static_cast<TreeNode*>(to));
  for (unsigned i = 0; i < count; ++i) node->children[i] = static_cast<TreeNode*>(children[i]);
}

Box to_box(const auto& b) {
  Box box;
  box.include(make_vec3(b.lower_x, b.lower_y, b.lower_z));
  box.include(make_vec3(b.upper_x, b.upper_y, b.upper_z));
  return box;
}

RTCBounds to_bounds(const Box& b) {
  return {b.low[0], b.low[1], b.low[2], 0, b.high[0], b.high[1], b.high[2], 0};
}

void set_wide_bounds(void* to, const RTCBounds** bounds, unsigned count, void*) {
  auto* node = static_cast<WideNode*>(static_cast<TreeNode*>(to));
  for (unsigned i = 0; i < count; ++i) node->bounds[i] = to_box(*bounds[i]);
}

void* create_wide_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, size_t count,
                       void*) {
  auto* leaf = new_node<WideLeaf>(allocator);
  leaf->primitive_count = int(std::min<size_t>(count, BVH_WIDTH));
  for (int i = 0; i < leaf->primitive_count; ++i) leaf->primitives[i] = int(primitives[i].primID);
  return static_cast<TreeNode*>(leaf);
}

/// A node of a binary tree. Its boxes are those of its parts.
struct PairNode : TreeNode {
  const TreeNode* children[2];
};
struct PartsLeaf : TreeNode {
  std::size_t part_count;
  TreePart parts[BVH_WIDTH];
};

void* create_parts_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, size_t count,
                        void*) {
  auto* leaf = new_node<PartsLeaf>(allocator);
  leaf->part_count = std::min<size_t>(count, BVH_WIDTH);
  for (std::size_t i = 0; i < leaf->part_count; ++i)
    leaf->parts[i] = {to_box(primitives[i]), int(primitives[i].primID)};
  return static_cast<TreeNode*>(leaf);
}

/// The data for the builder's callbacks.
struct SplitTriangles {
  std::span<const Triangle> triangles;
};

void split(const RTCBuildPrimitive* part, unsigned axis, float position, RTCBounds* below, RTCBounds* above,
           void* build) {
  const Triangle& triangle = static_cast<SplitTriangles*>(build)->triangles[part->primID];
  const auto [low, high] = split_bounds(triangle, to_box(*part), int(axis), position);
  *below = to_bounds(low);
  *above = to_bounds(high);
}

/// The builder's input, with each primitive's index.
std::vector<RTCBuildPrimitive> build_primitives(std::span<const Box> boxes) {
  std::vector<RTCBuildPrimitive> all;
  all.reserve(boxes.size());
  for (const Box& b : boxes)
    all.push_back({b.low[0], b.low[1], b.low[2], 0, b.high[0], b.high[1], b.high[2], unsigned(all.size())});
  return all;
}

RTCBuildArguments build_arguments(RTCBVH bvh, std::vector<RTCBuildPrimitive>& primitives, std::size_t count,
                                  int in_leaf) {
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.byteSize = sizeof arguments;
  arguments.sahBlockSize = BVH_WIDTH;
  arguments.minLeafSize = unsigned(in_leaf);  // testing a full leaf costs as much as testing a node
  arguments.maxLeafSize = unsigned(in_leaf);
  arguments.traversalCost = 1;
  arguments.intersectionCost = 1;
  arguments.bvh = bvh;
  arguments.primitives = primitives.data();
  arguments.primitiveCount = count;
  arguments.primitiveArrayCapacity = primitives.size();
  return arguments;
}

Expected<const TreeNode*> build(const RTCBuildArguments& arguments) {
  if (const auto* root = static_cast<const TreeNode*>(rtcBuildBVH(&arguments))) return root;
  return fail("Embree could not build a hierarchy over " + std::to_string(arguments.primitiveCount) +
              " primitives");
}

/// The margin for hits is added last. Otherwise triangles that only touch a plane would be split there.
void add_tree(BinaryTree& to, const TreeNode* node, std::span<const Triangle> triangles, int parent) {
  if (node->child_count == 0) {
    PartsLeaf leaf = *static_cast<const PartsLeaf*>(node);
    const std::span parts(leaf.parts, leaf.part_count);
    for (TreePart& part : parts) part.box.widen(hit_margin(triangles[std::size_t(part.primitive)]));
    to.add_parts(parts, parent);
    return;
  }
  const int at = to.add_node(Box(), parent);
  for (const TreeNode* child : static_cast<const PairNode*>(node)->children)
    add_tree(to, child, triangles, at);
  for (const int child : to[at].child) to[at].box.include(to[child].box);
}

}  // namespace

void EmbreeBuilder::Release::operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }

Expected<EmbreeBuilder> EmbreeBuilder::start(unsigned threads) {
  EmbreeBuilder builder(rtcNewDevice(("isa=sse2,threads=" + std::to_string(threads)).c_str()));
  if (!builder.device_) return fail("Embree does not start on this machine");
  return builder;
}

Expected<WideTree> EmbreeBuilder::wide_tree(std::span<const Box> boxes, int in_leaf) const {
  std::shared_ptr<RTCBVHTy> bvh(rtcNewBVH(device_.get()), BvhRelease());
  std::vector<RTCBuildPrimitive> primitives = build_primitives(boxes);
  RTCBuildArguments arguments = build_arguments(bvh.get(), primitives, primitives.size(), in_leaf);
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = BVH_WIDTH;
  arguments.maxDepth = kMaxTreeDepth;
  arguments.createNode = create_node<WideNode>;
  arguments.setNodeChildren = set_children<WideNode>;
  arguments.setNodeBounds = set_wide_bounds;
  arguments.createLeaf = create_wide_leaf;
  const Expected<const TreeNode*> root = build(arguments);
  if (!root) return std::unexpected(root.error());
  return WideTree{*root, std::move(bvh)};
}

Expected<BinaryTree> EmbreeBuilder::binary_tree(std::span<const Triangle> triangles) const {
  const BvhHandle bvh(rtcNewBVH(device_.get()));
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (const Triangle& triangle : triangles) boxes.push_back(bounds_of(triangle));
  std::vector<RTCBuildPrimitive> primitives = build_primitives(boxes);
  primitives.resize(std::size_t(double(boxes.size()) * kRoomForParts));
  RTCBuildArguments arguments = build_arguments(bvh.get(), primitives, boxes.size(), BVH_WIDTH);
  SplitTriangles splits{triangles};
  arguments.buildQuality = RTC_BUILD_QUALITY_HIGH;
  arguments.maxBranchingFactor = 2;
  arguments.maxDepth = kMaxBinaryDepth;
  arguments.createNode = create_node<PairNode>;
  arguments.setNodeChildren = set_children<PairNode>;
  arguments.setNodeBounds = [](void*, const RTCBounds**, unsigned, void*) {};
  arguments.createLeaf = create_parts_leaf;
  arguments.splitPrimitive = split;
  arguments.userPtr = &splits;
  const Expected<const TreeNode*> root = build(arguments);
  if (!root) return std::unexpected(root.error());
  BinaryTree tree;
  add_tree(tree, *root, triangles, -1);
  return tree;
}

}  // namespace penumbra
