#include "scenes/device/hierarchy/hierarchy_cache.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <tuple>
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

/// A hash of all that the hierarchy, or its still part, depends on: the build IDs of the program and Embree,
/// and the positions.
std::string key_of(const std::string& ids, const HierarchyInput& input) {
  std::vector<PrimitiveGroup> groups(input.groups.begin(), input.groups.end());
  auto [triangles, quadrics, instances] = std::tuple(input.triangles, input.quadrics, input.instances);
  ContentHasher hasher;
  if (const auto& still = input.still) {
    // Quadric leaves have the number of all triangles.
    const std::uint64_t all = still->quadrics > 0 ? triangles.size() : 0;
    const double extent = hierarchy_extent(input);
    hasher.add(bytes_of(std::span<const std::uint64_t>(&all, 1)));
    hasher.add(bytes_of(std::span<const double>(&extent, 1)));
    triangles = triangles.first(std::size_t(still->triangles));
    quadrics = quadrics.first(std::size_t(still->quadrics));
    instances = instances.first(std::size_t(still->instances));
    groups.resize(std::size_t(still->groups));
    groups[0].triangle_count = still->triangles - groups[0].first_triangle;
    groups[0].quadric_count = still->quadrics - groups[0].first_quadric;
  }
  const std::uint64_t sizes[] = {ids.size(),    triangles.size(), quadrics.size(),
                                 groups.size(), instances.size(), input.still ? 1u : 0u};
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
  for (PrimitiveGroup& group : groups) group.root = 0;
  hasher.add(bytes_of(std::span<const PrimitiveGroup>(groups)));
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

/// Nothing if the file does not fit the primitives, of which it is over the first ones.
std::optional<Hierarchy> decoded(Bytes bytes, std::span<const Triangle> triangles, const StillRecords& part) {
  std::vector<Counts> counts;
  std::vector<LeafTriangles> leaves;
  Hierarchy hierarchy;
  if (!take(bytes, 1, counts) || !take(bytes, counts[0].nodes, hierarchy.nodes) ||
      !take(bytes, counts[0].roots, hierarchy.roots) || !take(bytes, counts[0].triangle_leaves, leaves) ||
      !take(bytes, counts[0].quadric_leaves, hierarchy.quadric_leaves) || !bytes.empty() ||
      hierarchy.roots.size() != std::size_t(part.groups))
    return {};
  hierarchy.triangle_leaves.reserve(leaves.size());
  for (const LeafTriangles& leaf : leaves) {
    if (!std::ranges::all_of(leaf, [&](int i) { return i < part.triangles; })) return {};
    hierarchy.triangle_leaves.push_back(triangle_leaf(leaf, triangles));
  }
  const HierarchyTables tables{.nodes = hierarchy.nodes,
                               .roots = hierarchy.roots,
                               .triangle_leaves = hierarchy.triangle_leaves,
                               .quadric_leaves = hierarchy.quadric_leaves,
                               .triangles = int(triangles.size()),
                               .quadrics = part.quadrics,
                               .instances = part.instances};
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

Expected<Hierarchy> HierarchyCache::find_or_build(const HierarchyInput& input) const {
  Expected<Hierarchy> hierarchy = find_or_build_part(input);
  if (hierarchy && input.still)
    if (Expected<void> done = add_moving(input, *hierarchy); !done) return std::unexpected(done.error());
  return hierarchy;
}

/// The whole hierarchy, or its still part if there is one.
Expected<Hierarchy> HierarchyCache::find_or_build_part(const HierarchyInput& input) const {
  const auto build = [&] { return input.still ? build_still(input) : build_hierarchy(input); };
  const StillRecords all = {.triangles = int(input.triangles.size()),
                            .quadrics = int(input.quadrics.size()),
                            .groups = int(input.groups.size()),
                            .instances = int(input.instances.size())};
  const StillRecords& part = input.still ? *input.still : all;
  const std::string ids = build_ids({"libembree"});
  if (!files_.enabled() || ids.empty() ||
      std::size_t(part.triangles) + std::size_t(part.quadrics) + std::size_t(part.instances) <
          fewest_primitives_)
    return build();
  const std::string key = key_of(ids, input);
  if (const auto found = files_.find(key).bytes)
    if (auto hierarchy = decoded(*found, input.triangles, part)) {
      if (input.still) hierarchy->still = still_part(input, *hierarchy);
      return std::move(*hierarchy);
    }
  Expected<Hierarchy> built = build();
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
