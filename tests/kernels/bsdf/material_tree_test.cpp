// Random material trees: which leaves numbers choose, and how much light passes, against recursion.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra {
namespace {

constexpr int kNumbers = 256 * LANES;

Material leaf_material(bool passes) {
  Material m{};
  m.first = m.second = m.weight_texture = m.bend_texture = -1;
  m.passes = passes ? PASSES_ALL : PASSES_NONE;
  return m;
}

int passes_of(const std::vector<Material>& materials, int material) {
  return material < 0 ? PASSES_ALL : materials[std::size_t(material)].passes;
}

/// Black, some leaves, then branches of what came before; some weights are 0 or 1.
SceneTables random_trees(RandomNumbers& random) {
  SceneTables tables;
  tables.header.features = FEATURE_NESTED;
  for (int k = 0; k < 4; ++k) tables.materials.push_back(leaf_material(k == 3));
  for (int k = 0; k < 8; ++k) {
    Material m = leaf_material(false);
    m.branches = 1;
    m.first = int(random.below(tables.materials.size() + 1)) - 1;
    m.second = int(random.below(tables.materials.size() + 1)) - 1;
    m.weight = float(random.below(5)) / 4.0f;
    if (random.below(2) == 0) m.weight = float(random.uniform());
    const int first = passes_of(tables.materials, m.first), second = passes_of(tables.materials, m.second);
    m.passes = first == second ? first : PASSES_SOME;
    tables.materials.push_back(m);
  }
  return tables;
}

/// The probability of every leaf; -1: of nothing. Returns the number of ways to leaves.
int add_leaves(const SceneTables& tables, int material, double share, std::map<int, double>& leaves) {
  const bool passes = passes_of(tables.materials, material) == PASSES_ALL;
  const bool branches = material >= 0 && tables.materials[std::size_t(material)].branches != 0;
  if (passes || !branches) {
    leaves[passes ? -1 : material] += share;
    return 1;
  }
  const Material& m = tables.materials[std::size_t(material)];
  return add_leaves(tables, m.first, share * (1 - double(m.weight)), leaves) +
         add_leaves(tables, m.second, share * double(m.weight), leaves);
}

TEST(MaterialTree, NumbersChooseLeavesByTheirWeightsAndSharesAreThoseOfNothing) {
  RandomNumbers random(7);
  for (int k = 0; k < 200; ++k) {
    SceneTables tables = random_trees(random);
    const Scene scene = tables.scene();
    const int root = int(tables.materials.size()) - 1;
    std::map<int, double> expected, found;
    const int ways = add_leaves(tables, root, 1, expected);
    double shares = 0;
    for (int first = 0; first < kNumbers; first += LANES) {
      Surfaces surfaces{};
      float numbers[LANES], again[LANES], passing[LANES];
      int leaves[LANES];
      for (int j = 0; j < LANES; ++j) {
        numbers[j] = again[j] = (float(first + j) + 0.5f) / float(kNumbers);
        surfaces.material[j] = leaves[j] = root;
      }
      float shares_of_leaves[LANES];
      walk_to_leaves(&scene, &surfaces, numbers, leaves);
      leaf_shares(&scene, &surfaces, leaves, shares_of_leaves);
      pass_leaves(numbers, shares_of_leaves, leaves);
      PassingShares walks;
      passing_shares(&scene, &surfaces, again, &walks, passing);
      for (int j = 0; j < LANES; ++j) {
        found[leaves[j]] += 1.0 / kNumbers;
        ASSERT_TRUE(passing[j] >= 0 && passing[j] <= 1);
        shares += double(passing[j]) / kNumbers;
      }
    }
    // Each way is an interval of the numbers, off by half a distance between them at either end; what
    // rounding of the numbers moves is less.
    const double tolerance = (ways + 1.0) / kNumbers;
    for (const auto& [leaf, probability] : expected)
      EXPECT_NEAR(found[leaf], probability, tolerance) << "leaf " << leaf << " of tree " << k;
    for (const auto& [leaf, frequency] : found) EXPECT_TRUE(expected.contains(leaf)) << leaf;
    EXPECT_NEAR(shares, expected[-1], tolerance) << "tree " << k;
  }
}

/// Masks in masks, and blends of masks with what is opaque, take no chance.
TEST(MaterialTree, SharesOfMasksAreExact) {
  SceneTables tables;
  tables.header.features = FEATURE_NESTED;
  tables.materials.push_back(leaf_material(false));
  const auto add = [&](int first, int second, float weight) {
    Material m = leaf_material(false);
    m.branches = 1;
    m.first = first;
    m.second = second;
    m.weight = weight;
    m.passes = PASSES_SOME;
    tables.materials.push_back(m);
    return int(tables.materials.size()) - 1;
  };
  const int mask = add(-1, 0, 0.25f), in_mask = add(-1, mask, 0.5f), blend = add(in_mask, 0, 0.75f);
  const Scene scene = tables.scene();
  const double expected[] = {0.75, 0.5 + 0.5 * 0.75, 0.25 * (0.5 + 0.5 * 0.75)};
  for (int k = 0; k < 3; ++k) {
    Surfaces surfaces{};
    float numbers[LANES], passing[LANES];
    for (int j = 0; j < LANES; ++j) {
      numbers[j] = float(j) / LANES;
      surfaces.material[j] = k == 0 ? mask : k == 1 ? in_mask : blend;
    }
    PassingShares walks;
    passing_shares(&scene, &surfaces, numbers, &walks, passing);
    for (const float share : passing) EXPECT_EQ(share, float(expected[k]));
  }
}

}  // namespace
}  // namespace penumbra
