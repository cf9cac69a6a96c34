// The table of cells for the choice of lights, tested with every number of a sampler.
#include "scenes/device/light_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"

namespace penumbra::light_table_test {
namespace {

constexpr std::uint32_t kNumbers = 1u << 24;

/// Somewhere of their own.
std::vector<LightBounds> places_of(std::size_t count) {
  RandomNumbers random(7);
  std::vector<LightBounds> bounds(count);
  for (LightBounds& b : bounds) {
    b.low = b.high = {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    b.infinite = false;
  }
  return bounds;
}

SceneTables tables_of(const std::vector<double>& power) {
  SceneTables tables;
  tables.lights.resize(power.size());
  tables.light_cells = set_light_probabilities(tables.lights, power, places_of(power.size()));
  return tables;
}

std::vector<std::uint32_t> count_choices(SceneTables& tables) {
  const Scene scene = tables.scene();
  std::vector<std::uint32_t> count(tables.lights.size());
  for (std::uint32_t k = 0; k < kNumbers; ++k)
    ++count.at(std::size_t(choose_light(&scene, float(k) * 0x1p-24f, 0.0f).light));
  return count;
}

std::vector<double> random_power(std::size_t count, double spread, std::uint64_t seed) {
  RandomNumbers random(seed);
  std::vector<double> power(count);
  for (double& p : power) p = std::pow(10.0, random.between(-spread, spread));
  return power;
}

/// Powers of lights, made where a test needs them: there are many.
struct Powers {
  std::size_t lights;
  std::vector<double> (*make)();
};

class LightTable : public testing::TestWithParam<Powers> {
 protected:
  const std::vector<double> power_ = GetParam().make();
};
INSTANTIATE_TEST_SUITE_P(Powers, LightTable,
                         testing::ValuesIn(std::vector<Powers>{
                             {1, [] { return std::vector<double>{3}; }},
                             {2,
                              [] {
                                return std::vector<double>{1, 1};
                              }},
                             {3,
                              [] {
                                return std::vector<double>{1, 2, 3};
                              }},
                             {4,
                              [] {
                                return std::vector<double>{0, 5, 0, 1};
                              }},
                             {3,
                              [] {
                                return std::vector<double>{1e-12, 1, 1e-12};
                              }},
                             {2,
                              [] {
                                return std::vector<double>{1e300, 1e299};
                              }},
                             {36, [] { return std::vector<double>(36, 1.0); }},
                             {7, [] { return random_power(7, 1, 1); }},
                             {1000, [] { return random_power(1000, 3, 2); }},
                             {100'000, [] { return random_power(100'000, 1, 3); }},
                             {99'999, [] { return std::vector<double>(99'999, 1.0); }}}),
                         [](const auto& tested) {
                           return std::to_string(tested.param.lights) + "Lights" +
                                  std::to_string(tested.index);
                         });

TEST_P(LightTable, ProbabilitiesAreThoseOfTheChoicesExactly) {
  SceneTables tables = tables_of(power_);
  const std::vector<std::uint32_t> count = count_choices(tables);
  for (std::size_t i = 0; i < count.size(); ++i)
    ASSERT_EQ(tables.lights[i].pmf, float(count[i]) * 0x1p-24f) << "light " << i;
}

TEST_P(LightTable, ProbabilitiesFollowThePower) {
  const std::vector<double>& power = power_;
  SceneTables tables = tables_of(power);
  const double total = std::accumulate(power.begin(), power.end(), 0.0),
               cell = 1.0 / double(tables.light_cells.size());
  double sum = 0;
  // Lights whose share is less than a cell have a whole one, which the others lack: at most a cell for each
  // light, in proportion to what they have.
  for (std::size_t i = 0; i < power.size(); ++i) {
    const double share = power[i] / total, pmf = tables.lights[i].pmf;
    sum += pmf;
    ASSERT_LE(pmf, std::max(share, 0.0) + cell * 1.000001) << "light " << i;
    ASSERT_GE(pmf, share * (1 - double(power.size()) * cell) - cell) << "light " << i;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST_P(LightTable, CellsOfALightAreNeighboursInTheOrderOfPlaces) {
  SceneTables tables = tables_of(power_);
  std::vector<bool> seen(tables.lights.size(), false);
  for (std::size_t k = 0; k < tables.light_cells.size(); ++k) {
    const auto light = std::size_t(tables.light_cells[k]);
    if (k > 0 && tables.light_cells[k - 1] == int(light)) continue;
    ASSERT_FALSE(seen[light]) << "light " << light << " at cell " << k;
    ASSERT_EQ(std::uint32_t(tables.lights[light].start), k * (kNumbers / tables.light_cells.size()));
    seen[light] = true;
  }
}

TEST_P(LightTable, WhatIsLeftOfTheNumbersFillsTheIntervalEvenly) {
  SceneTables tables = tables_of(power_);
  const std::vector<Light>& lights = tables.lights;
  const Scene scene = tables.scene();
  std::vector<std::vector<bool>> taken(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) taken[i].resize(std::size_t(lights[i].pmf * 0x1p24f));
  for (std::uint32_t k = 0; k < kNumbers; ++k) {
    // In the middle of its part of the interval.
    const ChosenLight choice = choose_light(&scene, float(k) * 0x1p-24f, 0.5f);
    std::vector<bool>& parts = taken[std::size_t(choice.light)];
    ASSERT_GE(choice.u, 0.0f);
    const auto part = std::size_t(double(choice.u) * double(parts.size()));
    ASSERT_LT(part, parts.size());
    // From 2^23 parts on their middles are no floats.
    if (parts.size() < (1u << 23)) {
      ASSERT_FALSE(parts[part]) << "light " << choice.light;
    }
    parts[part] = true;
  }
}

TEST_P(LightTable, NeighboursStayNeighbours) {
  // Numbers that choose one light differ by their distance over its probability.
  SceneTables tables = tables_of(power_);
  const std::vector<Light>& lights = tables.lights;
  const Scene scene = tables.scene();
  RandomNumbers random(5);
  for (int i = 0; i < 10'000; ++i) {
    const auto k = std::uint32_t(random.below(kNumbers - 1));
    const ChosenLight a = choose_light(&scene, float(k) * 0x1p-24f, 0.5f),
                      b = choose_light(&scene, float(k + 1) * 0x1p-24f, 0.5f);
    if (a.light != b.light) continue;
    const double step = 0x1p-24 / lights[std::size_t(a.light)].pmf;
    ASSERT_NEAR(b.u - a.u, step, 0x1p-23) << "light " << a.light;
  }
}

TEST_P(LightTable, EveryLightWithPowerCanBeChosen) {
  const std::vector<Light> lights = tables_of(power_).lights;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    ASSERT_EQ(lights[i].pmf > 0, power_[i] > 0) << "light " << i;
  }
}

TEST(LightTableOfPlaces, NeighboursInSpaceAreNearEachOther) {
  // 16 x 16 lights of a plane, in any order: those of a quarter of the table are one quarter of the plane.
  std::vector<Light> lights(256);
  std::vector<LightBounds> bounds(256);
  for (std::size_t i = 0; i < 256; ++i) {
    const std::size_t place = i * 37 % 256;
    bounds[i].low = bounds[i].high = {double(place % 16), double(place / 16), 3};
    bounds[i].infinite = false;
  }
  const std::vector<int> cells = set_light_probabilities(lights, std::vector<double>(256, 1.0), bounds);
  for (std::size_t quarter = 0; quarter < 4; ++quarter) {
    glm::dvec3 low(99), high(-99);
    for (std::size_t k = 0; k < cells.size() / 4; ++k) {
      const glm::dvec3 p = bounds[std::size_t(cells[quarter * (cells.size() / 4) + k])].low;
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    EXPECT_EQ(high - low, glm::dvec3(7, 7, 0)) << quarter;
  }
}

TEST(LightTableOfPlaces, LightsWithoutAPlaceAreLast) {
  std::vector<Light> lights(3);
  std::vector<LightBounds> bounds(3);
  bounds[1].low = bounds[1].high = {1, 2, 3};
  bounds[1].infinite = false;
  const std::vector<int> cells = set_light_probabilities(lights, std::vector<double>(3, 1.0), bounds);
  EXPECT_EQ(cells.front(), 1);
  EXPECT_EQ(cells.back(), 2);
}

TEST(LightTableWithoutPower, GivesNoLightAProbability) {
  SceneTables tables = tables_of({0, 0});
  EXPECT_EQ(tables.lights[0].pmf, 0);
  EXPECT_EQ(tables.lights[1].pmf, 0);
  const Scene scene = tables.scene();
  EXPECT_EQ(choose_light(&scene, 0.7f, 0.5f).pmf, 0);
}

TEST(LightTableWithInfinitePower, ChoosesItAlways) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Light> lights = tables_of({1, infinity}).lights;
  EXPECT_GT(lights[1].pmf, 0.9f);
  EXPECT_TRUE(std::isfinite(lights[0].pmf));
}

}  // namespace
}  // namespace penumbra::light_table_test
