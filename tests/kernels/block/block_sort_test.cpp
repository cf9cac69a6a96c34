// Sorting of paths by the BSDF family that they hit: every field moves with its path, and the sort is stable.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "tests/kernels/block/path_values.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra::block_sort_test {
namespace {

constexpr int kCapacity = 5 * LANES;

/// Triangles and spheres whose sides are black, diffuse or Phong.
SceneTables families_scene(RandomNumbers& random, std::uint64_t features) {
  SceneTables tables;
  tables.header.features = features;
  for (const int family : {FAMILY_BLACK, FAMILY_DIFFUSE, FAMILY_PHONG, FAMILY_DIFFUSE}) {
    tables.materials.push_back({});
    tables.materials.back().family = family;
  }
  for (int k = 0; k < 9; ++k) {
    tables.add_triangle(make_vec3(0, 0, 0), make_vec3(1, 0, 0), make_vec3(0, 1, 0));
    tables.triangles.back().front = int(random.below(4));
    tables.triangles.back().back = int(random.below(4));
    tables.add_sphere(make_vec3(0, 0, 0), 1);
    tables.quadrics.back().front = int(random.below(4));
    tables.quadrics.back().back = int(random.below(4));
  }
  return tables;
}

enum {
#define NUMBER_FIELD(type, name, needs, travels) FIELD_##name,
  PATH_FIELDS(NUMBER_FIELD) kFieldCount
#undef NUMBER_FIELD
};

/// Of the front, or of the back of what is black in front.
int family_of(const SceneTables& tables, int primitive) {
  if (primitive < 0) return FAMILY_BLACK;
  const int triangles = int(tables.triangles.size());
  const auto side = [&](const auto& p) { return p.front > 0 ? p.front : p.back; };
  const int material = primitive < triangles ? side(tables.triangles[std::size_t(primitive)])
                                             : side(tables.quadrics[std::size_t(primitive - triangles)]);
  return tables.materials[std::size_t(material)].family;
}

void expect_sorted(std::uint64_t features, RandomNumbers& random) {
  SceneTables tables = families_scene(random, features);
  const Scene scene = tables.scene();
  const int primitives = int(tables.triangles.size() + tables.quadrics.size());
  BlockMemory memory(features, kCapacity, 0);
  const PathState paths = memory.block().paths;
  const int count = 1 + int(random.below(kCapacity));
  const bool chooses = (features & FEATURE_NESTED) != 0;
  std::vector<int> hits(kCapacity), leaves(kCapacity, -1);
  for (int i = 0; i < kCapacity; ++i) {
    fill_path(features, paths, i);
    hits[std::size_t(i)] = int(random.below(std::uint64_t(primitives + 1))) - 1;
    set_hit(&paths, i, hits[std::size_t(i)]);
    if (!chooses) continue;
    leaves[std::size_t(i)] = int(random.below(5)) - 1;
    set_material(&paths, i, leaves[std::size_t(i)]);
  }
  const auto family = [&](int i) {
    const int leaf = leaves[std::size_t(i)];
    return leaf < 0 ? family_of(tables, hits[std::size_t(i)]) : tables.materials[std::size_t(leaf)].family;
  };
  std::vector<int> order(std::size_t(count), 0);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](int i) { return std::pair(family(i), i); });

  sort_by_family(&scene, &paths, count);
  for (int lane = 0; lane < kCapacity; ++lane) {
    // Lanes past the count stay.
    const int from = lane < count ? order[std::size_t(lane)] : lane;
    ASSERT_EQ(get_hit(&paths, lane), hits[std::size_t(from)]);
    if (chooses) {
      ASSERT_EQ(get_material(&paths, lane), leaves[std::size_t(from)]);
      set_material(&paths, lane, value_of<int>(FIELD_material, from));  // as it was filled
    }
    int field = 0;
#define CHECK_FIELD(type, name, needs, travels)                                    \
  if (is_moved(features, needs, travels)) {                                        \
    ASSERT_TRUE(same(get_##name(&paths, lane), value_of<type>(field, from)))       \
        << #name " of lane " << lane << " of " << count << ", which was " << from; \
  }                                                                                \
  ++field;
    PATH_FIELDS(CHECK_FIELD)
#undef CHECK_FIELD
  }
}

TEST(SortByFamily, EveryPathTakesAllThatTravelsAlong) {
  RandomNumbers random(1);
  for (const std::uint64_t more : std::initializer_list<std::uint64_t>{
           FEATURE_PATH | FEATURE_QUADRICS, FEATURE_DIRECT | FEATURE_QUADRICS, FEATURE_DIRECT | FEATURE_UV,
           FEATURE_PATH | FEATURE_QUADRICS | FEATURE_POLYGONS | FEATURE_PROJECTED, FEATURE_ALL})
    for (int k = 0; k < 100 && !testing::Test::HasFatalFailure(); ++k)
      expect_sorted(more | FEATURE_MIXED_FAMILIES, random);
}

}  // namespace
}  // namespace penumbra::block_sort_test
