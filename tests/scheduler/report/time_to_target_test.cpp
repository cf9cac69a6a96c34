#include "scheduler/report/time_to_target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

namespace penumbra {
namespace {

using Reach = TimeToTarget::Kind;

constexpr double kRounding = 1e-12;

/// error = 1 / cost at 1, 2, 4, 8.
const std::vector<CostError> kInverse = {{1, 1}, {2, 0.5}, {4, 0.25}, {8, 0.125}};

TEST(TimeToTarget, InterpolatesInLogarithms) {
  for (const double cost : {1.0, 1.3, 2.0, 3.9, 8.0}) {
    const auto time = time_to_target(kInverse, 1 / cost);
    ASSERT_TRUE(time) << cost;
    EXPECT_NEAR(time->cost, cost, kRounding) << cost;
    EXPECT_EQ(time->kind, Reach::kMeasured) << cost;
  }
}

TEST(TimeToTarget, InterpolatesBetweenTheTwoPointsAlone) {
  // From (2, 1) to (8, 1/16) the slope is -2, whatever the rest of the curve does.
  const std::vector<CostError> points = {{1, 50}, {2, 1}, {8, 1.0 / 16}, {16, 1e-9}};
  EXPECT_NEAR(time_to_target(points, 0.25)->cost, 4, kRounding);
}

TEST(TimeToTarget, ExtrapolatesNothing) {
  const auto longer = time_to_target(kInverse, 0.1249), shorter = time_to_target(kInverse, 1.001);
  ASSERT_TRUE(longer && shorter);
  EXPECT_EQ(longer->kind, Reach::kNotReached);
  EXPECT_EQ(longer->cost, 8) << "the longest run, which is not enough";
  EXPECT_EQ(shorter->kind, Reach::kShorter);
  EXPECT_EQ(shorter->cost, 1) << "the shortest run, which is more than enough";
  EXPECT_EQ(time_to_target(kInverse, 0.125)->kind, Reach::kMeasured);
  EXPECT_EQ(time_to_target(kInverse, 1)->kind, Reach::kMeasured);
  EXPECT_EQ(time_to_target(std::vector<CostError>{{3, 0.5}}, 0.1)->kind, Reach::kNotReached)
      << "a single run";
}

TEST(TimeToTarget, NeedsPointsAndATarget) {
  EXPECT_FALSE(time_to_target({}, 0.5));
  EXPECT_FALSE(time_to_target(kInverse, 0));
  EXPECT_FALSE(time_to_target(std::vector<CostError>{{3, -1}}, 0.5)) << "below the noise of the reference";
}

TEST(TimeToTarget, TakesTheLastFallOfACurveThatRisesBetween) {
  const std::vector<CostError> points = {{1, 1}, {2, 0.1}, {4, 1}, {8, 0.25}};
  // From (4, 1) to (8, 1/4): slope -2, 1/2 at 4 sqrt 2.
  EXPECT_NEAR(time_to_target(points, 0.5)->cost, 4 * std::sqrt(2.0), kRounding);
}

TEST(TimeToTarget, CurveThatEndsAboveTheTargetHasNotReachedIt) {
  const std::vector<CostError> points = {{1, 4}, {2, 0.1}, {4, 1}, {8, 0.6}};
  const auto time = time_to_target(points, 0.5);
  ASSERT_TRUE(time);
  EXPECT_EQ(time->kind, Reach::kNotReached);
  EXPECT_EQ(time->cost, 8);
}

TEST(TimeToTarget, OrderDoesNotMatterAndBadPointsAreLeftOut) {
  const std::vector<CostError> points = {{8, 0.125}, {3, -1}, {1, 1}, {4, 0.25}, {5, std::nan("")}, {2, 0.5}};
  EXPECT_NEAR(time_to_target(points, 1 / 3.0)->cost, 3, kRounding);
}

TimeToTarget time(Reach kind, double cost) { return {kind, cost}; }

std::optional<std::size_t> fastest_of(const std::vector<std::optional<TimeToTarget>>& times) {
  return fastest(times);
}

TEST(Fastest, IsTheLeastMeasuredTime) {
  EXPECT_EQ(fastest_of({time(Reach::kMeasured, 3), time(Reach::kMeasured, 2), std::nullopt}), 1u);
  EXPECT_EQ(fastest_of({time(Reach::kMeasured, 3), time(Reach::kNotReached, 4)}), 0u);
}

TEST(Fastest, IsNobodyWhereItIsNotKnown) {
  EXPECT_FALSE(fastest_of({time(Reach::kMeasured, 3), time(Reach::kNotReached, 1)}))
      << "the other may need no more than 1.1";
  EXPECT_FALSE(fastest_of({time(Reach::kMeasured, 3), time(Reach::kShorter, 4)}));
  EXPECT_FALSE(fastest_of({time(Reach::kShorter, 3), time(Reach::kShorter, 4)}));
  EXPECT_FALSE(fastest_of({time(Reach::kNotReached, 3), time(Reach::kNotReached, 4)}));
  EXPECT_FALSE(fastest_of({time(Reach::kMeasured, 3)})) << "nothing to be faster than";
  EXPECT_FALSE(fastest_of({}));
}

TEST(Fastest, MayBeFasterThanItsShortestRun) {
  EXPECT_EQ(fastest_of({time(Reach::kMeasured, 3), time(Reach::kShorter, 2), time(Reach::kNotReached, 5)}),
            1u);
}

}  // namespace
}  // namespace penumbra
