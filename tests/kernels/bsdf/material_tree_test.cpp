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
constexpr int kBranches = 8;

Material leaf_material(bool passes) {
  Material m{};
  m.first = m.second = m.weight_texture = m.bend_texture = -1;
  m.passes = passes ? PASSES_ALL : PASSES_NONE;
  m.passing_leaves = passes ? 1 : 0;
  return m;
}

int passes_of(const std::vector<Material>& materials, int material) {
  return material < 0 ? PASSES_ALL : materials[std::size_t(material)].passes;
}

int passing_leaves_of(const std::vector<Material>& materials, int material) {
  return material < 0 ? 1 : materials[std::size_t(material)].passing_leaves;
}

/// Black, some leaves, then branches of what came before; some weights are 0 or 1.
SceneTables random_trees(RandomNumbers& random) {
  SceneTables tables;
  tables.header.features = FEATURE_NESTED;
  for (int k = 0; k < 4; ++k) tables.materials.push_back(leaf_material(k == 3));
  for (int k = 0; k < kBranches; ++k) {
    Material m = leaf_material(false);
    m.branches = 1;
    m.first = int(random.below(tables.materials.size() + 1)) - 1;
    m.second = int(random.below(tables.materials.size() + 1)) - 1;
    m.weight = float(random.below(5)) / 4.0f;
    if (random.below(2) == 0) m.weight = float(random.uniform());
    const int first = passes_of(tables.materials, m.first), second = passes_of(tables.materials, m.second);
    m.passes = first == second ? first : PASSES_SOME;
    m.passing_leaves =
        passing_leaves_of(tables.materials, m.first) + passing_leaves_of(tables.materials, m.second);
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
    // Sums of at most `ways` products of weights, below 1, in single precision.
    const double rounding = (2 * kBranches + ways) * 0x1p-24;
    for (int first = 0; first < kNumbers; first += LANES) {
      Surfaces surfaces{};
      float numbers[LANES];
      int leaves[LANES];
      for (int j = 0; j < LANES; ++j) {
        numbers[j] = (float(first + j) + 0.5f) / float(kNumbers);
        surfaces.material[j] = leaves[j] = root;
      }
      float shares_of_leaves[LANES];
      walk_to_leaves(&scene, &surfaces, numbers, leaves);
      leaf_shares(&scene, &surfaces, leaves, shares_of_leaves);
      pass_leaves(numbers, shares_of_leaves, leaves);
      PaneTints light;
      float shares[LANES];
      passing_light(&scene, &surfaces, shares, &light);
      for (int j = 0; j < LANES; ++j) {
        found[leaves[j]] += 1.0 / kNumbers;
        ASSERT_NEAR(shares[j], expected[-1], rounding) << "tree " << k;
      }
    }
    // Each way is an interval of the numbers, off by half a distance between them at either end; what
    // rounding of the numbers moves is less.
    const double tolerance = (ways + 1.0) / kNumbers;
    for (const auto& [leaf, probability] : expected)
      EXPECT_NEAR(found[leaf], probability, tolerance) << "leaf " << leaf << " of tree " << k;
    for (const auto& [leaf, frequency] : found) EXPECT_TRUE(expected.contains(leaf)) << leaf;
  }
}

}  // namespace
}  // namespace penumbra
