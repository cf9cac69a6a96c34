// Fits slopes to synthetic curves of known slope.
#include "scheduler/report/slope_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scheduler/image/metrics/distributions.h"

namespace penumbra {
namespace {

/// error = scale cost^slope e^noise at budgets a factor of two apart.
std::vector<CostError> power_law(int count, double slope, double noise, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<CostError> points;
  for (int i = 0; i < count; ++i) {
    const double cost = 0.01 * std::exp2(i);
    points.push_back({cost, 0.3 * std::pow(cost, slope) * std::exp(noise * normal(random))});
  }
  return points;
}

TEST(StudentT, AgreesWithClosedForms) {
  // dof 1 is Cauchy's distribution, dof 2 has t = (2p - 1) sqrt(2 / (1 - (2p - 1)^2)).
  for (const double p : {0.6, 0.9, 0.975, 0.9995}) {
    EXPECT_NEAR(student_t_quantile(p, 1) / std::tan(M_PI * (p - 0.5)), 1, 1e-11) << p;
    const double a = 2 * p - 1;
    EXPECT_NEAR(student_t_quantile(p, 2) / (a * std::sqrt(2 / (1 - a * a))), 1, 1e-11) << p;
    EXPECT_DOUBLE_EQ(student_t_quantile(1 - p, 2), -student_t_quantile(1 - (1 - p), 2));
  }
  EXPECT_EQ(student_t_quantile(0.5, 7), 0);
}

TEST(StudentT, AgreesWithTables) {
  // Abramowitz and Stegun, table 26.10; and the normal distribution for many degrees of freedom.
  EXPECT_NEAR(student_t_quantile(0.975, 4), 2.776, 5e-4);
  EXPECT_NEAR(student_t_quantile(0.975, 10), 2.228, 5e-4);
  EXPECT_NEAR(student_t_quantile(0.995, 30), 2.750, 5e-4);
  EXPECT_NEAR(student_t_quantile(0.975, 1e7), 1.959964, 1e-6);
}

TEST(StudentT, DistributionAgreesWithQuadratureOfTheDensity) {
  // Simpson's rule from 0; its error at this step is far below the tolerance.
  for (const double dof : {3.0, 5.5, 40.0}) {
    const auto density = [&](double t) {
      return std::exp(std::lgamma(0.5 * (dof + 1)) - std::lgamma(0.5 * dof)) / std::sqrt(dof * M_PI) *
             std::pow(1 + t * t / dof, -0.5 * (dof + 1));
    };
    constexpr int kSteps = 4000;
    const double end = 2.3, h = end / kSteps;
    double sum = density(0) + density(end);
    for (int i = 1; i < kSteps; ++i) sum += (i % 2 == 1 ? 4 : 2) * density(i * h);
    EXPECT_NEAR(student_t_cdf(end, dof), 0.5 + sum * h / 3, 1e-12) << dof;
    EXPECT_NEAR(student_t_cdf(-end, dof), 0.5 - sum * h / 3, 1e-12) << dof;
  }
}

TEST(SlopeFit, IsExactWithoutNoise) {
  std::mt19937_64 random(1);
  const auto fit = fit_slope(power_law(6, -1.5, 0, random));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, -1.5, 1e-12);
  EXPECT_NEAR(std::exp(fit->intercept), 0.3, 1e-12);
  EXPECT_NEAR(fit->low, -1.5, 1e-10);
  EXPECT_NEAR(fit->high, -1.5, 1e-10);
  EXPECT_EQ(fit->points, 6);
  EXPECT_NEAR(fit->error_at(2), 0.3 * std::pow(2, -1.5), 1e-12);
}

TEST(SlopeFit, IntervalHoldsTheSlopeAsOftenAsItSays) {
  // Of 1000 intervals of 95 % (or 80 %), about 950 (800) hold the slope: within 4 standard deviations of the
  // binomial distribution, exceeded by chance once in 16000.
  constexpr int kSets = 1000;
  constexpr double kDeviations = 4;
  for (const double confidence : {0.95, 0.8}) {
    for (const int count : {3, 7}) {
      std::mt19937_64 random(17 + count);
      int held = 0;
      for (int i = 0; i < kSets; ++i)
        held += fit_slope(power_law(count, -1, 0.2, random), confidence)->holds(-1) ? 1 : 0;
      const double spread = std::sqrt(kSets * confidence * (1 - confidence));
      EXPECT_NEAR(held, kSets * confidence, kDeviations * spread) << count << " points, " << confidence;
    }
  }
}

TEST(SlopeFit, LeavesOutWhatHasNoLogarithm) {
  std::mt19937_64 random(3);
  auto points = power_law(5, -1, 0, random);
  points.push_back({1, -1e-9});
  points.push_back({1, 0});
  points.push_back({0, 1});
  points.push_back({1, std::nan("")});
  points.push_back({INFINITY, 1});
  const auto fit = fit_slope(points);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->points, 5);
  EXPECT_NEAR(fit->slope, -1, 1e-12);
}

TEST(SlopeFit, SaysNothingWhereThereIsNothingToSay) {
  const std::vector<CostError> two = {{1, 1}, {2, 0.5}};
  EXPECT_FALSE(fit_slope(two));
  const std::vector<CostError> one_cost = {{2, 1}, {2, 0.5}, {2, 0.25}};
  EXPECT_FALSE(fit_slope(one_cost));
  EXPECT_FALSE(fit_slope({}));
}

TEST(Slope, NeedsThreePointsAndTwoOctaves) {
  const std::vector<CostError> octaves = {{1, 1}, {2, 0.5}, {4, 0.25}};
  ASSERT_TRUE(slope_of(octaves, "times").fit);
  EXPECT_NEAR(slope_of(octaves, "times").fit->slope, -1, 1e-12);
  EXPECT_EQ(slope_of(octaves, "times").none_because, "");
  // Five points in 1.9 octaves.
  const std::vector<CostError> near = {{1, 1}, {1.5, 0.6}, {2, 0.5}, {3, 0.3}, {3.7, 0.2}};
  EXPECT_TRUE(fit_slope(near));
  EXPECT_FALSE(slope_of(near, "times").fit);
  EXPECT_EQ(slope_of(near, "times").none_because, "times span less than a factor of 4");
  // Far apart, but one error is below the noise of the reference.
  const std::vector<CostError> two = {{1, 1}, {2, 0.5}, {64, -1e-6}};
  EXPECT_FALSE(slope_of(two, "times").fit);
  EXPECT_EQ(slope_of(two, "times").none_because, "fewer than 3 budgets above the reference's noise");
  EXPECT_FALSE(slope_of({}, "times").fit);
}

}  // namespace
}  // namespace penumbra
