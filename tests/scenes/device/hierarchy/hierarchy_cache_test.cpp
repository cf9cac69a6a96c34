// Hierarchies from a folder have the bytes of those that are built, and belong to their positions.
#include "scenes/device/hierarchy/hierarchy_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <random>
#include <span>

#include "tests/support/temporary_folder.h"

namespace penumbra::hierarchy_cache_test {
namespace {

namespace fs = std::filesystem;

template <typename Record>
bool same_records(const std::vector<Record>& a, const std::vector<Record>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Record)) == 0;
}
bool same(const Hierarchy& a, const Hierarchy& b) {
  return same_records(a.nodes, b.nodes) && same_records(a.roots, b.roots) &&
         same_records(a.triangle_leaves, b.triangle_leaves) &&
         same_records(a.quadric_leaves, b.quadric_leaves);
}

/// The scene's own triangles and spheres, and a group of both that is placed twice.
struct Primitives {
  std::vector<Triangle> triangles;
  std::vector<Quadric> quadrics;
  std::vector<PrimitiveGroup> groups;
  std::vector<Instance> instances;

  [[nodiscard]] Expected<Hierarchy> built() const {
    return build_hierarchy(triangles, quadrics, groups, instances);
  }
  [[nodiscard]] Expected<Hierarchy> from(const HierarchyCache& cache) const {
    return cache.find_or_build({triangles, quadrics, groups, instances});
  }
};

Primitives primitives(int triangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> number(-1, 1);
  const auto point = [&] { return make_vec3(number(random), number(random), number(random)); };
  Primitives all;
  const auto add = [&](int count) {
    for (int i = 0; i < count; ++i) {
      Triangle t{};
      t.p0 = point();
      t.p1 = point();
      t.p2 = point();
      all.triangles.push_back(t);
    }
    for (int i = 0; i < 3; ++i) {
      Quadric sphere{};
      sphere.kind = QUADRIC_SPHERE;
      sphere.center = point();
      sphere.radius = 0.3f;
      all.quadrics.push_back(sphere);
    }
  };
  add(triangles);
  add(50);
  all.groups = {{0, 0, triangles, 0, 3}, {0, triangles, 50, 3, 3}};
  for (const float at : {-2.0f, 3.0f}) {
    Instance instance{};
    instance.x = instance.row_x = make_vec3(1, 0, 0);
    instance.y = instance.row_y = make_vec3(0, 1, 0);
    instance.z = instance.row_z = make_vec3(0, 0, 1);
    instance.at = make_vec3(at, 0, 0);
    instance.group = 1;
    all.instances.push_back(instance);
  }
  return all;
}

class HierarchyFolder : public testing::Test {
 protected:
  [[nodiscard]] fs::path only_file() const {
    const std::vector<std::string> names = folder_.names();
    EXPECT_EQ(names.size(), 1u);
    return folder_ / names.at(0);
  }
  const TemporaryFolder folder_;
  const HierarchyCache cache_{folder_.path(), 1};
  const Primitives scene_ = primitives(500);
  const Expected<Hierarchy> built_ = scene_.built();
};

TEST_F(HierarchyFolder, ReturnsTheSameBytes) {
  ASSERT_TRUE(built_);
  for (int i = 0; i < 3; ++i) {
    const auto found = scene_.from(cache_);
    ASSERT_TRUE(found);
    EXPECT_TRUE(same(*found, *built_)) << i;
    EXPECT_EQ(folder_.names().size(), 1u);
  }
}

TEST_F(HierarchyFolder, IsReadAndNotOnlyWritten) {
  ASSERT_TRUE(scene_.from(cache_));
  // Another hierarchy of as many triangles under this name, whole by the cache's measure.
  Primitives other = scene_;
  std::ranges::reverse(other.triangles);
  const TemporaryFolder elsewhere;
  ASSERT_TRUE(other.from(HierarchyCache(elsewhere.path(), 1)));
  const fs::path file = only_file();
  const std::vector<std::string> names = elsewhere.names();
  const CheckedCache ours(folder_.path(), ".hierarchy", {}), theirs(elsewhere.path(), ".hierarchy", {});
  const auto foreign = theirs.find(fs::path(names.at(0)).stem().string());
  ASSERT_TRUE(foreign.bytes);
  ASSERT_TRUE(ours.keep(file.stem().string(), *foreign.bytes));
  const auto found = scene_.from(cache_);
  ASSERT_TRUE(found);
  EXPECT_FALSE(same(*found, *built_));
}

TEST_F(HierarchyFolder, KeepsOnlyWhatIsStill) {
  Primitives shot = scene_;
  shot.groups = {{0, 0, int(shot.triangles.size()), 0, int(shot.quadrics.size())}};
  const StillRecords still{.triangles = int(shot.triangles.size()) - 50, .quadrics = 2, .groups = 1};
  for (int frame = 0; frame < 3; ++frame) {
    for (Triangle& t : std::span(shot.triangles).last(50)) t.p0.x += 0.1f;
    const HierarchyInput input{shot.triangles, shot.quadrics, shot.groups, {}, still};
    const auto found = cache_.find_or_build(input), built = build_hierarchy(input);
    ASSERT_TRUE(found && built);
    EXPECT_TRUE(same(*found, *built)) << frame;
    EXPECT_EQ(found->still.nodes, built->still.nodes);
    EXPECT_LT(std::size_t(found->still.nodes), found->nodes.size());
    EXPECT_EQ(folder_.names().size(), 1u);
  }
}

TEST_F(HierarchyFolder, TellsPositionsApartAndNothingElse) {
  ASSERT_TRUE(scene_.from(cache_));
  Primitives painted = scene_;
  for (Triangle& t : painted.triangles) t.front = 5;
  ASSERT_TRUE(painted.from(cache_));
  EXPECT_EQ(folder_.names().size(), 1u) << "materials do not matter";
  std::size_t files = 1;
  const auto expect_another = [&](const char* what, const auto& change) {
    Primitives changed = scene_;
    change(changed);
    const auto found = changed.from(cache_);
    ASSERT_TRUE(found);
    EXPECT_TRUE(same(*found, *changed.built())) << what;
    EXPECT_EQ(folder_.names().size(), ++files) << what;
  };
  expect_another("vertex", [](Primitives& p) { p.triangles[499].p2.z += 1e-6f; });
  expect_another("vertex of a group", [](Primitives& p) { p.triangles[500].p0.x = 2; });
  expect_another("sphere", [](Primitives& p) { p.quadrics[0].radius = 0.5f; });
  expect_another("instance", [](Primitives& p) { p.instances[1].at.y = 1; });
  expect_another("groups", [](Primitives& p) {
    p.groups[0].triangle_count -= 1;
    p.groups[1].first_triangle -= 1;
    p.groups[1].triangle_count += 1;
  });
  expect_another("order", [](Primitives& p) { std::swap(p.triangles[0], p.triangles[1]); });
}

TEST_F(HierarchyFolder, ReplacesWhatIsDamagedOrDoesNotFit) {
  ASSERT_TRUE(scene_.from(cache_));
  const fs::path file = only_file();
  const std::string whole = file_contents(file);
  const auto expect_rebuilt = [&](const std::string& what) {
    const auto found = scene_.from(cache_);
    ASSERT_TRUE(found) << what;
    EXPECT_TRUE(same(*found, *built_)) << what;
    EXPECT_EQ(file_contents(file), whole) << what;
  };
  for (const std::size_t at : {std::size_t(0), std::size_t(100), whole.size() / 2, whole.size() - 1}) {
    std::string changed = whole;
    changed[at] = char(changed[at] ^ 1);
    write_text(file, changed);
    expect_rebuilt("byte " + std::to_string(at));
    write_text(file, whole.substr(0, at));
    expect_rebuilt("cut at " + std::to_string(at));
  }
  // Whole by the cache's measure, but counts and indices of a larger scene.
  const CheckedCache files(folder_.path(), ".hierarchy", {});
  const std::string key = file.stem().string();
  const std::vector<std::uint8_t> bytes = files.find(key).bytes.value();
  for (const std::size_t count : {0u, 8u, 16u, 24u}) {
    std::vector<std::uint8_t> changed = bytes;
    changed[count + 7] = 0x7f;
    ASSERT_TRUE(files.keep(key, changed));
    expect_rebuilt("count " + std::to_string(count));
  }
  const Hierarchy& h = *built_;
  const std::size_t nodes = 32, roots = nodes + h.nodes.size() * sizeof(BvhNode);
  const std::size_t leaves = roots + h.roots.size() * sizeof(int), end = bytes.size();
  const int triangles = int(scene_.triangles.size()), all = triangles + int(scene_.quadrics.size());
  const int leaf_count = int(h.triangle_leaves.size() + h.quadric_leaves.size() + scene_.instances.size());
  const auto expect_rebuilt_with = [&](std::size_t at, int index, const std::string& what) {
    std::vector<std::uint8_t> changed = bytes;
    std::memcpy(changed.data() + at, &index, sizeof index);
    ASSERT_TRUE(files.keep(key, changed));
    expect_rebuilt(what);
  };
  const std::size_t child = nodes + offsetof(BvhNode, child);
  expect_rebuilt_with(child, 0, "a node within itself");
  expect_rebuilt_with(child, int(h.nodes.size()), "a node that is not there");
  expect_rebuilt_with(child, ~leaf_count, "a leaf that is not there");
  expect_rebuilt_with(roots, int(h.nodes.size()), "a root that is not there");
  expect_rebuilt_with(leaves, triangles, "a triangle that is not there");
  expect_rebuilt_with(end - sizeof(QuadricLeaf), all, "a sphere that is not there");
}

TEST_F(HierarchyFolder, IsNotNeeded) {
  write_text(folder_ / "file", "in the way");
  for (const fs::path& impossible : {folder_ / "file", fs::path("/proc/penumbra"), fs::path()}) {
    const auto found = scene_.from(HierarchyCache(impossible, 1));
    ASSERT_TRUE(found);
    EXPECT_TRUE(same(*found, *built_));
  }
  ASSERT_TRUE(scene_.from(HierarchyCache(folder_.path())));
  EXPECT_EQ(folder_.names().size(), 1u) << "small scenes are not stored";
}

}  // namespace
}  // namespace penumbra::hierarchy_cache_test
