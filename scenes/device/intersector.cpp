#include "scenes/device/intersector.h"

#include <array>
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

/// Collects distinct vertices and the triangles over them. Returns false if the scene is too large to test
/// every primitive.
bool collect_corners(SceneRecords& records) {
  if (!records.instances.empty() || records.triangles.size() > MAX_WHOLE_TRIANGLES ||
      records.quadrics.size() > kMaxWholeQuadrics)
    return false;
  std::map<std::array<float, 3>, int> index;
  const auto find = [&](const vec3& p) {
    const auto [at, added] = index.try_emplace({p.x, p.y, p.z}, int(records.vertices.size()));
    if (added) records.vertices.push_back(p);
    return at->second;
  };
  for (const Triangle& t : records.triangles) records.corners.push_back({find(t.p0), find(t.p1), find(t.p2)});
  return records.vertices.size() <= MAX_WHOLE_VERTICES;
}

}  // namespace

int intersector_for(std::size_t triangles) {
  return triangles > kMaxPortableTriangles ? INTERSECTOR_EMBREE : INTERSECTOR_PORTABLE;
}

Expected<void> add_intersector(IntersectorChoice choice, const HierarchyCache& cache, SceneHeader& header,
                               SceneRecords& records) {
  const bool either = collect_corners(records);
  header.intersector = choice == IntersectorChoice::kAuto     ? intersector_for(records.triangles.size())
                       : choice == IntersectorChoice::kEmbree ? INTERSECTOR_EMBREE
                                                              : INTERSECTOR_PORTABLE;
  const bool portable = header.intersector == INTERSECTOR_PORTABLE;
  if (portable && !(either && records.triangles.size() <= kMaxWholeTriangles)) {
    if (Expected<void> done = add_hierarchy(cache, records); !done) return done;
    header.features |= FEATURE_BVH;
  }
  if (!portable || !either) {
    records.corners.clear();
    records.vertices.clear();
  }
  return {};
}

Expected<void> add_hierarchy(const HierarchyCache& cache, SceneRecords& records) {
  const PrimitiveGroup all{0, 0, int(records.triangles.size()), 0, int(records.quadrics.size())};
  const std::span<const PrimitiveGroup> groups =
      records.groups.empty() ? std::span(&all, 1) : std::span<const PrimitiveGroup>(records.groups);
  Expected<Hierarchy> hierarchy =
      cache.find_or_build(records.triangles, records.quadrics, groups, records.instances);
  if (!hierarchy) return std::unexpected(hierarchy.error());
  for (std::size_t g = 0; g < records.groups.size(); ++g) records.groups[g].root = hierarchy->roots[g];
  records.nodes = std::move(hierarchy->nodes);
  records.triangle_leaves = std::move(hierarchy->triangle_leaves);
  records.quadric_leaves = std::move(hierarchy->quadric_leaves);
  return {};
}

Expected<void> TemporaryHierarchy::need() {
  if (!records_.nodes.empty()) return {};
  borrowed_ = true;
  return add_hierarchy(cache_, records_);
}

TemporaryHierarchy::~TemporaryHierarchy() {
  if (!borrowed_) return;
  for (PrimitiveGroup& group : records_.groups) group.root = 0;
  std::vector<BvhNode>().swap(records_.nodes);
  std::vector<TriangleLeaf>().swap(records_.triangle_leaves);
  std::vector<QuadricLeaf>().swap(records_.quadric_leaves);
}

}  // namespace penumbra
