#include "scenes/device/intersector.h"

#include <array>
#include <cstring>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "kernels/intersect/bvh_limits.h"

namespace penumbra {
namespace {

// Up to this many triangles, testing all of them in SIMD lanes is faster than any hierarchy.
constexpr std::size_t kMaxWholeTriangles = 64;
// Up to MAX_WHOLE_TRIANGLES that holds on some devices, which may choose, so such scenes have both.
// kMaxPortableTriangles: where Embree becomes as fast as our own hierarchy, measured by
// tests/benchmarks/traversal_benchmark.cpp.
constexpr std::size_t kMaxPortableTriangles = 4'000'000;
constexpr std::size_t kMaxWholeQuadrics = 16;

/// How many triangles and quadrics do not move while the shutter is open; they come first.
std::size_t still_triangles(const SceneRecords& records) {
  return records.triangles.size() - records.triangle_motions.size();
}
std::size_t still_quadrics(const SceneRecords& records) {
  return records.quadrics.size() - records.quadric_motions.size();
}

/// Collects distinct vertices and the triangles over them, of what does not move. Returns false if the scene
/// is too large to test every primitive.
bool collect_corners(SceneRecords& records) {
  const auto is_curve = [](const Quadric& q) { return is_curve_kind(q.kind); };
  if (std::ranges::any_of(records.quadrics, is_curve)) return false;
  if (!records.instances.empty() || still_triangles(records) > MAX_WHOLE_TRIANGLES ||
      still_quadrics(records) > kMaxWholeQuadrics)
    return false;
  std::map<std::array<float, 3>, int> index;
  const auto find = [&](const vec3& p) {
    const auto [at, added] = index.try_emplace({p.x, p.y, p.z}, int(records.vertices.size()));
    if (added) records.vertices.push_back(p);
    return at->second;
  };
  for (const Triangle& t : std::span(records.triangles).first(still_triangles(records)))
    records.corners.push_back({find(t.p0), find(t.p1), find(t.p2)});
  return records.vertices.size() <= MAX_WHOLE_VERTICES;
}

/// Whether the records are the first ones of a table of the scene.
template <typename Record>
bool begins_with(const DeviceScene& scene, TableSpan span, std::span<const Record> records) {
  const auto all = table<Record>(scene, span);
  return records.size() <= all.size() &&
         (records.empty() || std::memcmp(all.data(), records.data(), records.size_bytes()) == 0);
}

/// Whether both scenes have the same still groups; all of them, except that the first may have more
/// primitives that move.
bool same_still_groups(std::span<const PrimitiveGroup> a, std::span<const PrimitiveGroup> b, int count) {
  for (std::size_t g = 0; g < std::size_t(count); ++g) {
    if (a[g].first_triangle != b[g].first_triangle || a[g].first_quadric != b[g].first_quadric) return false;
    if (g > 0 && (a[g].triangle_count != b[g].triangle_count || a[g].quadric_count != b[g].quadric_count))
      return false;
  }
  return true;
}

/// What build_still makes, taken from another scene. Nothing if that scene has other still primitives.
std::optional<Hierarchy> still_hierarchy(const HierarchyInput& input, const DeviceScene& scene) {
  const StillRecords &wanted = *input.still, &there = scene.still;
  const TableSpans& tables = scene.header.tables;
  if (there.nodes == 0 || there.triangles != wanted.triangles || there.quadrics != wanted.quadrics ||
      there.groups != wanted.groups || there.instances != wanted.instances ||
      there.extent != hierarchy_extent(input))
    return {};
  const PrimitiveGroup all{0, 0, tables.triangles.count, 0, tables.quadrics.count};
  auto groups = table<PrimitiveGroup>(scene, tables.groups);
  if (groups.empty()) groups = std::span(&all, 1);
  if (!same_still_groups(groups, input.groups, wanted.groups) ||
      !begins_with(scene, tables.triangles, input.triangles.first(std::size_t(wanted.triangles))) ||
      !begins_with(scene, tables.quadrics, input.quadrics.first(std::size_t(wanted.quadrics))) ||
      !begins_with(scene, tables.instances, input.instances.first(std::size_t(wanted.instances))))
    return {};
  const auto nodes = table<BvhNode>(scene, tables.nodes).first(std::size_t(there.nodes));
  const auto triangle_leaves =
      table<TriangleLeaf>(scene, tables.triangle_leaves).first(std::size_t(there.triangle_leaves));
  const auto quadric_leaves =
      table<QuadricLeaf>(scene, tables.quadric_leaves).first(std::size_t(there.quadric_leaves));
  Hierarchy still{.nodes = {nodes.begin(), nodes.end()},
                  .roots = {},
                  .triangle_leaves = {triangle_leaves.begin(), triangle_leaves.end()},
                  .quadric_leaves = {quadric_leaves.begin(), quadric_leaves.end()},
                  .still = there};
  for (const PrimitiveGroup& group : groups.first(std::size_t(wanted.groups)))
    still.roots.push_back(group.root);
  // Quadrics count from the number of all triangles on.
  const int more = int(input.triangles.size()) - tables.triangles.count;
  for (QuadricLeaf& leaf : still.quadric_leaves)
    for (int& primitive : leaf.primitive)
      if (primitive >= 0) primitive += more;
  return still;
}

}  // namespace

int intersector_for(std::size_t triangles) {
  return triangles > kMaxPortableTriangles ? INTERSECTOR_EMBREE : INTERSECTOR_PORTABLE;
}

Expected<void> add_intersector(IntersectorChoice choice, HierarchySource& source, SceneHeader& header,
                               SceneRecords& records) {
  const bool either = collect_corners(records);
  header.intersector = choice == IntersectorChoice::kAuto     ? intersector_for(records.triangles.size())
                       : choice == IntersectorChoice::kEmbree ? INTERSECTOR_EMBREE
                                                              : INTERSECTOR_PORTABLE;
  const bool portable = header.intersector == INTERSECTOR_PORTABLE;
  if (portable && !(either && still_triangles(records) <= kMaxWholeTriangles)) {
    if (Expected<void> done = source.add_hierarchy(records); !done) return done;
    header.features |= FEATURE_BVH;
  }
  // Rays that enter moving groups use their trees.
  if (!portable && !records.instance_motions.empty())
    if (Expected<void> done = source.add_hierarchy(records, true); !done) return done;
  if (!portable || !either) {
    records.corners.clear();
    records.vertices.clear();
  }
  return {};
}

Expected<void> HierarchySource::add_hierarchy(SceneRecords& records, bool groups_alone) {
  std::vector<PrimitiveGroup> groups = records.groups;
  if (groups.empty())
    groups.push_back({0, 0, int(still_triangles(records)), 0, int(still_quadrics(records))});
  if (groups_alone) groups[0] = {};
  const std::size_t instances = groups_alone ? 0 : records.instances.size() - records.instance_motions.size();
  const HierarchyInput input = {.triangles = records.triangles,
                                .quadrics = records.quadrics,
                                .groups = groups,
                                .instances = std::span(records.instances).first(instances),
                                .still = groups_alone ? std::nullopt : still_};
  Expected<Hierarchy> hierarchy = fail("");
  std::optional<Hierarchy> kept =
      still_ && earlier_ != nullptr ? still_hierarchy(input, *earlier_) : std::nullopt;
  if (kept) {
    hierarchy = std::move(*kept);
    if (Expected<void> done = add_moving(input, *hierarchy); !done) return done;
  } else {
    hierarchy = cache_.find_or_build(input);
  }
  if (!hierarchy) return std::unexpected(hierarchy.error());
  built_ = hierarchy->still;
  for (std::size_t g = 0; g < records.groups.size(); ++g) records.groups[g].root = hierarchy->roots[g];
  records.nodes = std::move(hierarchy->nodes);
  records.triangle_leaves = std::move(hierarchy->triangle_leaves);
  records.quadric_leaves = std::move(hierarchy->quadric_leaves);
  return {};
}

Expected<void> TemporaryHierarchy::need() {
  if (!records_.nodes.empty()) return {};
  borrowed_ = true;
  return source_.add_hierarchy(records_);
}

TemporaryHierarchy::~TemporaryHierarchy() {
  if (!borrowed_) return;
  for (PrimitiveGroup& group : records_.groups) group.root = 0;
  std::vector<BvhNode>().swap(records_.nodes);
  std::vector<TriangleLeaf>().swap(records_.triangle_leaves);
  std::vector<QuadricLeaf>().swap(records_.quadric_leaves);
}

}  // namespace penumbra
