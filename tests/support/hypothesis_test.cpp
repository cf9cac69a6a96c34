// Tests the t-test and the chi-square test on published data and on cases with results known by hand. Many
// seeded trials count their false alarms.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/support/normal_deviates.h"
#include "tests/support/statistics.h"

namespace penumbra::statistics {
namespace {

Sample sample_of(std::span<const double> values) {
  Sample sample;
  for (double value : values) sample.add(value);
  return sample;
}

// Hours of sleep gained with two drugs, ten patients (Student 1908); results as R's documentation of `sleep`
// gives them.
constexpr std::array kSleepA{0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0};
constexpr std::array kSleepB{1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};

TEST(TTest, StudentsSleepDataPaired) {
  Sample differences;
  for (std::size_t i = 0; i < kSleepA.size(); ++i) differences.add(kSleepA[i] - kSleepB[i]);
  const TestResult result = t_test(differences, 0);
  EXPECT_NEAR(result.statistic, -4.0621, 5e-5);
  EXPECT_EQ(result.dof, 9);
  EXPECT_NEAR(result.p, 0.002833, 5e-7);
}

TEST(TTest, StudentsSleepDataWelch) {
  const TestResult result = welch_t_test(sample_of(kSleepA), sample_of(kSleepB));
  EXPECT_NEAR(result.statistic, -1.8608, 5e-5);
  EXPECT_NEAR(result.dof, 17.776, 5e-4);
  EXPECT_NEAR(result.p, 0.07939, 5e-6);
}

TEST(TTest, ConstantSamples) {
  const Sample ones(1000, 1.0, 0.0);
  EXPECT_EQ(t_test(ones, 1.0).p, 1);
  EXPECT_EQ(t_test(ones, 1.0001).p, 0);
  EXPECT_EQ(t_test(ones, 1.0001, 2e-4).p, 1) << "within the allowance for rounding";
  EXPECT_EQ(welch_t_test(ones, ones).p, 1);
  EXPECT_EQ(welch_t_test(ones, Sample(10, 2.0, 0.0)).p, 0);
}

TEST(TTest, WhatCannotBeJudgedFails) {
  EXPECT_EQ(t_test(Sample(), 0).p, 0);
  EXPECT_EQ(t_test(Sample(1, 3.0, 0.0), 1).p, 0);
  EXPECT_EQ(t_test(Sample(10, std::nan(""), 1.0), 1).p, 0);
}

TEST(TTest, FalseAlarmsAreAsRareAsNominal) {
  // Five values each: far from normal limits, where only the right degrees of freedom keep the rate.
  std::mt19937_64 random(1);
  NormalDeviates normal(3, 2);
  constexpr int kTrials = 20000;
  int one_sample = 0, two_sample = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Sample a, b;
    for (int i = 0; i < 5; ++i) a.add(normal(random));
    for (int i = 0; i < 5; ++i) b.add(normal(random));
    one_sample += t_test(a, 3).p < 0.05;
    two_sample += welch_t_test(a, b).p < 0.05;
  }
  const double sigma = std::sqrt(kTrials * 0.05 * 0.95);
  EXPECT_NEAR(one_sample, kTrials * 0.05, 4 * sigma);
  // Welch's degrees of freedom are approximate; with equal variances the test is a little cautious.
  EXPECT_LT(two_sample, kTrials * 0.05 + 4 * sigma);
  EXPECT_GT(two_sample, kTrials * 0.04 - 4 * sigma);
}

TEST(TTest, FindsASmallBias) {
  std::mt19937_64 random(2);
  std::exponential_distribution<double> exponential(1);
  Sample sample;
  for (int i = 0; i < 100000; ++i) sample.add(exponential(random));
  EXPECT_GT(t_test(sample, 1).p, 0.01);
  EXPECT_LT(t_test(sample, 1.02).p, 1e-6) << "six standard errors off";
}

TEST(ChiSquareTest, MendelsPeas) {
  constexpr std::array kObserved{315.0, 108.0, 101.0, 32.0};
  constexpr std::array kExpected{312.75, 104.25, 104.25, 34.75};
  const TestResult result = chi_square_test(kObserved, kExpected);
  EXPECT_NEAR(result.statistic, 0.470024, 5e-7);
  EXPECT_EQ(result.dof, 3);
  EXPECT_NEAR(result.p, 0.925426, 5e-6);
}

TEST(ChiSquareTest, PoolsRareCells) {
  // 2 + 2 + 3 make the first pool, 6 and 10 stand alone, in whatever order the cells come.
  constexpr std::array kExpected{10.0, 2.0, 6.0, 3.0, 2.0};
  constexpr std::array kObserved{9.0, 1.0, 8.0, 4.0, 1.0};
  const TestResult result = chi_square_test(kObserved, kExpected);
  EXPECT_EQ(result.dof, 2);
  EXPECT_NEAR(result.statistic, 1.0 / 7 + 4.0 / 6 + 1.0 / 10, 1e-14);
}

TEST(ChiSquareTest, LeftOverCellsJoinTheLastPool) {
  constexpr std::array kExpected{4.0, 4.0, 4.0, 4.0, 4.0};
  constexpr std::array kObserved{4.0, 4.0, 4.0, 4.0, 5.0};
  const TestResult result = chi_square_test(kObserved, kExpected);
  EXPECT_EQ(result.dof, 1) << "8 and 12";
  EXPECT_NEAR(result.statistic, 1.0 / 12, 1e-14);
}

TEST(ChiSquareTest, CountsWhereNoneCanBe) {
  constexpr std::array kExpected{50.0, 50.0, 0.0};
  EXPECT_EQ(chi_square_test(std::array{50.0, 50.0, 0.0}, kExpected).p, 1);
  EXPECT_EQ(chi_square_test(std::array{50.0, 50.0, 1.0}, kExpected).p, 0);
}

TEST(ChiSquareTest, RefusesWhatItCannotJudge) {
  EXPECT_THROW(chi_square_test(std::array{1.0, 1.0}, std::array{1.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(chi_square_test(std::array{1.0}, std::array{1.0, 1.0}), std::invalid_argument);
  EXPECT_THROW(chi_square_test(std::array{9.0, -1.0}, std::array{9.0, 9.0}), std::invalid_argument);
  EXPECT_THROW(chi_square_test(std::array{9.0, 9.0}, std::array{9.0, std::nan("")}), std::invalid_argument);
}

TEST(ChiSquareTest, FalseAlarmsAreAsRareAsNominal) {
  std::mt19937_64 random(3);
  const std::vector<double> weights{0.3, 0.25, 0.2, 0.15, 0.06, 0.03, 0.007, 0.003};
  std::discrete_distribution<int> cells(weights.begin(), weights.end());
  constexpr int kTrials = 5000, kCounts = 1000;
  std::vector<double> expected;
  for (double weight : weights) expected.push_back(weight * kCounts);
  int alarms = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> observed(weights.size());
    for (int i = 0; i < kCounts; ++i) ++observed[cells(random)];
    alarms += chi_square_test(observed, expected).p < 0.05;
  }
  EXPECT_NEAR(alarms, kTrials * 0.05, 4 * std::sqrt(kTrials * 0.05 * 0.95));
}

}  // namespace
}  // namespace penumbra::statistics
