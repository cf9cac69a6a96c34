// Weights of multiple importance sampling.
#include "kernels/light/mis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

// A quotient, a product, a sum and a quotient.
constexpr double kTolerance = 4 * 0x1p-24;

TEST(MisWeight, IsTheHeuristics) {
  RandomNumbers random(1);
  for (int i = 0; i < 100'000; ++i) {
    const float mine = float(std::pow(10.0, random.between(-10, 10))),
                other = float(std::pow(10.0, random.between(-10, 10)));
    const double a = mine, b = other;
    EXPECT_NEAR(mis_weight(HEURISTIC_BALANCE, mine, other), a / (a + b), kTolerance);
    EXPECT_NEAR(mis_weight(HEURISTIC_POWER, mine, other), a * a / (a * a + b * b), kTolerance);
  }
}

TEST(MisWeight, SumsToOneOverTheStrategies) {
  RandomNumbers random(2);
  for (int heuristic : {HEURISTIC_BALANCE, HEURISTIC_POWER})
    for (int i = 0; i < 100'000; ++i) {
      const float a = float(std::pow(10.0, random.between(-30, 30))),
                  b = float(std::pow(10.0, random.between(-30, 30)));
      EXPECT_NEAR(mis_weight(heuristic, a, b) + mis_weight(heuristic, b, a), 1, kTolerance) << a << ", " << b;
    }
}

TEST(MisWeight, EndsOfTheRange) {
  const float huge = std::numeric_limits<float>::max(), tiny = std::numeric_limits<float>::min();
  for (int heuristic : {HEURISTIC_BALANCE, HEURISTIC_POWER}) {
    EXPECT_EQ(mis_weight(heuristic, 0, 0), 0);
    EXPECT_EQ(mis_weight(heuristic, 0, 1), 0);
    EXPECT_EQ(mis_weight(heuristic, 1, 0), 1);
    EXPECT_EQ(mis_weight(heuristic, huge, huge), 0.5f);
    EXPECT_EQ(mis_weight(heuristic, tiny, tiny), 0.5f);
    EXPECT_EQ(mis_weight(heuristic, huge, tiny), 1);
    EXPECT_EQ(mis_weight(heuristic, tiny, huge), 0);
  }
}

}  // namespace
}  // namespace penumbra
