#include "scenes/device/hierarchy/hierarchy_cache.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/content_hash.h"
#include "kernels/host/hierarchy_check.h"
#include "kernels/host/process.h"

namespace penumbra {
namespace {

using Bytes = std::span<const std::uint8_t>;

template <typename Record>
Bytes bytes_of(std::span<const Record> records) {
  return {reinterpret_cast<const std::uint8_t*>(records.data()), records.size_bytes()};
}

/// The numbers of records that follow.
struct Counts {
  std::uint64_t nodes, roots, triangle_leaves, quadric_leaves;
};
/// Of a leaf of triangles only the indices are stored: the scene has the vertices.
using LeafTriangles = std::array<int, BVH_WIDTH>;

/// A hash of all that the hierarchy depends on: the build IDs of the program and Embree, and the positions.
std::string key_of(const std::string& ids, std::span<const Triangle> triangles,
                   std::span<const Quadric> quadrics, std::span<const PrimitiveGroup> groups,
                   std::span<const Instance> instances) {
  ContentHasher hasher;
  const std::uint64_t sizes[] = {ids.size(), triangles.size(), quadrics.size(), groups.size(),
                                 instances.size()};
  hasher.add(bytes_of(std::span<const std::uint64_t>(sizes)));
  hasher.add(bytes_of(std::span<const char>(ids)));
  std::array<std::array<vec3, 3>, 1024> positions;
  for (std::size_t first = 0; first < triangles.size(); first += positions.size()) {
    const auto some = triangles.subspan(first, std::min(positions.size(), triangles.size() - first));
    std::ranges::transform(some, positions.begin(), [](const Triangle& t) {
      return std::array<vec3, 3>{t.p0, t.p1, t.p2};
    });
    hasher.add(bytes_of(std::span<const std::array<vec3, 3>>(positions).first(some.size())));
  }
  hasher.add(bytes_of(quadrics));
  for (PrimitiveGroup group : groups) {
    group.root = 0;
    hasher.add(bytes_of(std::span<const PrimitiveGroup>(&group, 1)));
  }
  hasher.add(bytes_of(instances));
  return hex_text(hasher.digest());
}

/// Takes records from the front of the bytes. Returns whether there were enough.
template <typename Record>
bool take(Bytes& bytes, std::uint64_t count, std::vector<Record>& records) {
  if (count > bytes.size() / sizeof(Record)) return false;
  if (count == 0) return true;
  records.resize(count);
  std::memcpy(records.data(), bytes.data(), count * sizeof(Record));
  bytes = bytes.subspan(count * sizeof(Record));
  return true;
}

/// Nothing if the file does not fit the primitives.
std::optional<Hierarchy> decoded(Bytes bytes, std::span<const Triangle> triangles, std::size_t quadrics,
                                 std::size_t groups, std::size_t instances) {
  std::vector<Counts> counts;
  std::vector<LeafTriangles> leaves;
  Hierarchy hierarchy;
  if (!take(bytes, 1, counts) || !take(bytes, counts[0].nodes, hierarchy.nodes) ||
      !take(bytes, counts[0].roots, hierarchy.roots) || !take(bytes, counts[0].triangle_leaves, leaves) ||
      !take(bytes, counts[0].quadric_leaves, hierarchy.quadric_leaves) || !bytes.empty() ||
      hierarchy.roots.size() != groups)
    return {};
  hierarchy.triangle_leaves.reserve(leaves.size());
  for (const LeafTriangles& leaf : leaves) {
    if (!std::ranges::all_of(leaf, [&](int i) { return i < int(triangles.size()); })) return {};
    hierarchy.triangle_leaves.push_back(triangle_leaf(leaf, triangles));
  }
  const HierarchyTables tables{.nodes = hierarchy.nodes,
                               .roots = hierarchy.roots,
                               .triangle_leaves = hierarchy.triangle_leaves,
                               .quadric_leaves = hierarchy.quadric_leaves,
                               .triangles = int(triangles.size()),
                               .quadrics = int(quadrics),
                               .instances = int(instances)};
  if (!hierarchy_problem(tables).empty()) return {};
  return hierarchy;
}

}  // namespace

std::filesystem::path default_hierarchy_cache() {
  return cache_folder("PENUMBRA_HIERARCHY_CACHE", "hierarchies");
}

HierarchyCache::HierarchyCache(std::filesystem::path folder, std::size_t fewest_primitives)
    : files_(std::move(folder), ".hierarchy", {.most_bytes = kHierarchyCacheBytes}),
      fewest_primitives_(fewest_primitives) {}

Expected<Hierarchy> HierarchyCache::find_or_build(std::span<const Triangle> triangles,
                                                  std::span<const Quadric> quadrics,
                                                  std::span<const PrimitiveGroup> groups,
                                                  std::span<const Instance> instances) const {
  const std::string ids = build_ids({"libembree"});
  if (!files_.enabled() || ids.empty() ||
      triangles.size() + quadrics.size() + instances.size() < fewest_primitives_)
    return build_hierarchy(triangles, quadrics, groups, instances);
  const std::string key = key_of(ids, triangles, quadrics, groups, instances);
  if (const auto found = files_.find(key).bytes)
    if (auto hierarchy = decoded(*found, triangles, quadrics.size(), groups.size(), instances.size()))
      return std::move(*hierarchy);
  Expected<Hierarchy> built = build_hierarchy(triangles, quadrics, groups, instances);
  if (!built) return built;
  std::vector<LeafTriangles> leaves(built->triangle_leaves.size());
  std::ranges::transform(built->triangle_leaves, leaves.begin(),
                         [](const TriangleLeaf& leaf) { return std::to_array(leaf.primitive); });
  const Counts counts = {built->nodes.size(), built->roots.size(), leaves.size(),
                         built->quadric_leaves.size()};
  const Bytes parts[] = {
      bytes_of(std::span<const Counts>(&counts, 1)), bytes_of(std::span<const BvhNode>(built->nodes)),
      bytes_of(std::span<const int>(built->roots)), bytes_of(std::span<const LeafTriangles>(leaves)),
      bytes_of(std::span<const QuadricLeaf>(built->quadric_leaves))};
  static_cast<void>(files_.keep(key, parts));  // it only saves time
  return built;
}

}  // namespace penumbra
