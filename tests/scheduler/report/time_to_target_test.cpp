#include "scheduler/report/time_to_target.h"

#include <gtest/gtest.h>

#include <cmath>

namespace penumbra {
namespace {

constexpr double kRounding = 1e-12;

/// error = 1 / cost at 1, 2, 4, 8.
const std::vector<CostError> kInverse = {{1, 1}, {2, 0.5}, {4, 0.25}, {8, 0.125}};

TEST(TimeToTarget, InterpolatesInLogarithms) {
  const auto fit = fit_slope(kInverse);
  for (const double cost : {1.0, 1.3, 2.0, 3.9, 8.0}) {
    const auto time = time_to_target(kInverse, fit, 1 / cost);
    ASSERT_TRUE(time) << cost;
    EXPECT_NEAR(time->cost, cost, kRounding) << cost;
    EXPECT_FALSE(time->extrapolated) << cost;
  }
}

TEST(TimeToTarget, InterpolatesBetweenTheTwoPointsAlone) {
  // From (2, 1) to (8, 1/16) the slope is -2, whatever the rest of the curve does.
  const std::vector<CostError> points = {{1, 50}, {2, 1}, {8, 1.0 / 16}, {16, 1e-9}};
  EXPECT_NEAR(time_to_target(points, fit_slope(points), 0.25)->cost, 4, kRounding);
}

TEST(TimeToTarget, FollowsTheFitOutsideAndSaysSo) {
  const auto fit = fit_slope(kInverse);
  const auto longer = time_to_target(kInverse, fit, 0.01), shorter = time_to_target(kInverse, fit, 10);
  ASSERT_TRUE(longer && shorter);
  EXPECT_NEAR(longer->cost, 100, 100 * kRounding);
  EXPECT_TRUE(longer->extrapolated);
  EXPECT_NEAR(shorter->cost, 0.1, kRounding);
  EXPECT_TRUE(shorter->extrapolated);
}

TEST(TimeToTarget, DoesNotGuessWithoutAFallingFit) {
  EXPECT_FALSE(time_to_target(kInverse, std::nullopt, 0.01));
  const std::vector<CostError> flat = {{1, 1}, {2, 1}, {4, 1}};
  EXPECT_FALSE(time_to_target(flat, fit_slope(flat), 0.5));
  EXPECT_FALSE(time_to_target({}, std::nullopt, 0.5));
  EXPECT_FALSE(time_to_target(kInverse, fit_slope(kInverse), 0));
}

TEST(TimeToTarget, TakesTheLastFallOfACurveThatRisesBetween) {
  const std::vector<CostError> points = {{1, 1}, {2, 0.1}, {4, 1}, {8, 0.25}};
  // From (4, 1) to (8, 1/4): slope -2, 1/2 at 4 sqrt 2.
  EXPECT_NEAR(time_to_target(points, fit_slope(points), 0.5)->cost, 4 * std::sqrt(2.0), kRounding);
}

TEST(TimeToTarget, CurveThatEndsAboveTheTargetHasNotReachedIt) {
  const std::vector<CostError> points = {{1, 4}, {2, 0.1}, {4, 1}, {8, 0.6}};
  const auto time = time_to_target(points, fit_slope(points), 0.5);
  ASSERT_TRUE(time);
  EXPECT_TRUE(time->extrapolated);
  EXPECT_GE(time->cost, 8);
}

TEST(TimeToTarget, OrderDoesNotMatterAndBadPointsAreLeftOut) {
  const std::vector<CostError> points = {{8, 0.125}, {3, -1}, {1, 1}, {4, 0.25}, {5, std::nan("")}, {2, 0.5}};
  EXPECT_NEAR(time_to_target(points, fit_slope(points), 1 / 3.0)->cost, 3, kRounding);
}

}  // namespace
}  // namespace penumbra
