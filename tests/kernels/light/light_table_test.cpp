// The alias table against a count of every number that a sampler can give.
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

namespace penumbra {
namespace {

constexpr std::uint32_t kNumbers = 1u << 24;

std::vector<Light> lights_of(const std::vector<double>& power) {
  std::vector<Light> lights(power.size());
  set_light_probabilities(lights, power);
  return lights;
}

std::vector<std::uint32_t> count_choices(const std::vector<Light>& lights) {
  SceneTables tables;
  tables.lights = lights;
  const Scene scene = tables.scene();
  std::vector<std::uint32_t> count(lights.size());
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

class LightTable : public testing::TestWithParam<std::vector<double>> {};
INSTANTIATE_TEST_SUITE_P(
    Powers, LightTable,
    testing::Values(std::vector<double>{3}, std::vector<double>{1, 1}, std::vector<double>{1, 2, 3},
                    std::vector<double>{0, 5, 0, 1}, std::vector<double>{1e-12, 1, 1e-12},
                    std::vector<double>{1e300, 1e299}, std::vector<double>(36, 1.0), random_power(7, 1, 1),
                    random_power(1000, 3, 2), random_power(100'000, 1, 3), std::vector<double>(99'999, 1.0)),
    [](const auto& tested) {
      return std::to_string(tested.param.size()) + "Lights" + std::to_string(tested.index);
    });

TEST_P(LightTable, ProbabilitiesAreThoseOfTheChoicesExactly) {
  const std::vector<Light> lights = lights_of(GetParam());
  const std::vector<std::uint32_t> count = count_choices(lights);
  for (std::size_t i = 0; i < lights.size(); ++i)
    ASSERT_EQ(lights[i].pmf, float(count[i]) * 0x1p-24f) << "light " << i;
}

TEST_P(LightTable, ProbabilitiesFollowThePower) {
  const std::vector<double>& power = GetParam();
  const std::vector<Light> lights = lights_of(power);
  const double total = std::accumulate(power.begin(), power.end(), 0.0);
  double sum = 0;
  // Each place of the table is some whole count of numbers, and so is each share of a place; a light's
  // probability is made of its own share and of those of the places whose alias it is.
  std::vector<double> shares(power.size(), 1);
  for (std::size_t i = 0; i < power.size(); ++i)
    if (lights[i].alias != int(i)) ++shares[std::size_t(lights[i].alias)];
  for (std::size_t i = 0; i < power.size(); ++i) {
    sum += lights[i].pmf;
    ASSERT_NEAR(lights[i].pmf, power[i] / total, 2.5 * shares[i] * 0x1p-24) << "light " << i;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST_P(LightTable, WhatIsLeftOfTheNumbersFillsTheIntervalEvenly) {
  const std::vector<Light> lights = lights_of(GetParam());
  SceneTables tables;
  tables.lights = lights;
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
  // Numbers of one place that choose one light differ by their distance over its probability.
  const std::vector<Light> lights = lights_of(GetParam());
  SceneTables tables;
  tables.lights = lights;
  const Scene scene = tables.scene();
  RandomNumbers random(5);
  for (int i = 0; i < 10'000; ++i) {
    const auto k = std::uint32_t(random.below(kNumbers - 1));
    const ChosenLight a = choose_light(&scene, float(k) * 0x1p-24f, 0.5f),
                      b = choose_light(&scene, float(k + 1) * 0x1p-24f, 0.5f);
    const double place = double(lights.size()) * 0x1p-24;
    if (a.light != b.light || int(k * place) != int((k + 1) * place)) continue;
    const double step = 0x1p-24 / lights[std::size_t(a.light)].pmf;
    ASSERT_NEAR(b.u - a.u, step, 0x1p-23) << "light " << a.light;
  }
}

TEST_P(LightTable, EveryLightWithPowerCanBeChosen) {
  const std::vector<Light> lights = lights_of(GetParam());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    ASSERT_EQ(lights[i].pmf > 0, GetParam()[i] > 0) << "light " << i;
  }
}

TEST(LightTableWithInfinitePower, ChoosesItAlways) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Light> lights = lights_of({1, infinity});
  EXPECT_GT(lights[1].pmf, 0.9f);
  EXPECT_TRUE(std::isfinite(lights[0].pmf));
}

}  // namespace
}  // namespace penumbra
