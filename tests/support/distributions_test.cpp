// Compares distribution functions with closed forms and printed tables.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/statistics.h"

namespace penumbra::statistics {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Normal, QuantilesOfTheTables) {
  EXPECT_DOUBLE_EQ(normal_quantile(0.5), 0);
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-14);
  EXPECT_NEAR(normal_quantile(0.995), 2.575829303548901, 1e-14);
  EXPECT_NEAR(normal_quantile(0.001), -3.090232306167813, 1e-14);
  EXPECT_NEAR(normal_quantile(1e-10), -6.361340902404056, 1e-13);
}

TEST(Normal, DistributionOfTheTables) {
  EXPECT_NEAR(normal_cdf(1), 0.841344746068543, 1e-15);
  EXPECT_NEAR(normal_cdf(-5) / 2.866515718791939e-7, 1, 1e-13);
}

TEST(Normal, QuantileInvertsTheDistribution) {
  for (double log_p = -300; log_p < 0; log_p += 0.7) {
    const double p = std::pow(10, log_p);
    EXPECT_NEAR(normal_cdf(normal_quantile(p)) / p, 1, 2e-12) << p;
  }
  EXPECT_EQ(normal_quantile(0), -kInfinity);
  EXPECT_EQ(normal_quantile(1), kInfinity);
  EXPECT_TRUE(std::isnan(normal_quantile(-0.1)));
  EXPECT_TRUE(std::isnan(normal_quantile(1.1)));
}

TEST(Student, OneDegreeIsCauchy) {
  for (double t : {1e-6, 0.1, 1.0, 3.0, 12.7062047, 1e4}) {
    EXPECT_NEAR(student_two_sided_p(t, 1), 1 - 2 / std::numbers::pi * std::atan(t), 1e-14) << t;
  }
}

TEST(Student, TwoDegreesInClosedForm) {
  for (double t : {1e-6, 0.1, 1.0, 3.0, 30.0}) {
    EXPECT_NEAR(student_two_sided_p(t, 2), 1 - t / std::sqrt(2 + t * t), 1e-14) << t;
  }
}

TEST(Student, CriticalValuesOfTheTables) {
  // Half a unit in the last printed digit, 5e-7, times the density of |t| there, below .12.
  EXPECT_NEAR(student_two_sided_p(2.228139, 10), 0.05, 6e-8);
  EXPECT_NEAR(student_two_sided_p(4.032143, 5), 0.01, 6e-8);
  EXPECT_NEAR(student_two_sided_p(2.042272, 30), 0.05, 6e-8);
  EXPECT_NEAR(student_two_sided_p(-2.042272, 30), 0.05, 6e-8);
  EXPECT_NEAR(student_two_sided_p(2.616, 120), 0.01, 5e-5) << "biometrical tables give 2.617, rounded";
}

TEST(Student, ManyDegreesAreNormal) {
  for (double t : {0.01, 1.0, 2.5758, 6.0}) {
    const double normal = 2 * normal_cdf(-t);
    EXPECT_DOUBLE_EQ(student_two_sided_p(t, kInfinity), normal);
    EXPECT_NEAR(student_two_sided_p(t, 1e6) / normal, 1, 5e-4) << t;
    for (const double dof : {1e8, 1e12, 1e16, 1e300})
      EXPECT_NEAR(student_two_sided_p(t, dof) / normal, 1, 5e-6) << t << " " << dof;
  }
}

TEST(Student, NormalDeviateOfTheSameProbability) {
  EXPECT_NEAR(student_to_normal(12.7062047361747, 1), 1.959963984540054, 1e-12);
  EXPECT_NEAR(student_to_normal(-12.7062047361747, 1), -1.959963984540054, 1e-12);
  EXPECT_NEAR(student_to_normal(3, kInfinity), 3, 1e-12);
  EXPECT_EQ(student_to_normal(0, 7), 0);
}

TEST(Beta, PolynomialCases) {
  EXPECT_NEAR(regularized_beta(1, 1, 0.3), 0.3, 1e-15);
  EXPECT_NEAR(regularized_beta(2, 3, 0.4), 0.5248, 1e-15) << "P(at least 2 of 4), p = .4";
  EXPECT_NEAR(regularized_beta(3, 2, 0.6), 1 - 0.5248, 1e-15) << "symmetry";
  EXPECT_EQ(regularized_beta(2, 3, 0), 0);
  EXPECT_EQ(regularized_beta(2, 3, 1), 1);
}

TEST(ChiSquare, TwoDegreesAreExponential) {
  for (double x : {1e-9, 0.5, 2.0, 20.0, 400.0}) {
    EXPECT_NEAR(chi_square_p(x, 2) / std::exp(-x / 2), 1, 1e-12) << x;
  }
}

TEST(ChiSquare, OneDegreeIsASquaredNormal) {
  for (double z : {0.1, 1.0, 1.959963984540054, 5.0}) {
    EXPECT_NEAR(chi_square_p(z * z, 1) / (2 * normal_cdf(-z)), 1, 1e-12) << z;
  }
}

TEST(ChiSquare, CriticalValuesOfTheTables) {
  EXPECT_NEAR(chi_square_p(3.841459, 1), 0.05, 5e-8);
  EXPECT_NEAR(chi_square_p(18.307038, 10), 0.05, 5e-8);
  EXPECT_NEAR(chi_square_p(124.342113, 100), 0.05, 5e-8);
  EXPECT_NEAR(chi_square_p(77.929465, 100), 0.95, 5e-8);
  EXPECT_NEAR(chi_square_p(6.634897, 1), 0.01, 5e-8);
}

TEST(Sidak, CombinesToTheSignificance) {
  EXPECT_DOUBLE_EQ(sidak_significance(0.01, 1), 0.01);
  EXPECT_NEAR(1 - std::pow(1 - sidak_significance(0.05, 20), 20), 0.05, 1e-15);
  EXPECT_NEAR(sidak_significance(0.01, 1'000'000'000) * 1e9, -std::log(0.99), 1e-12);
}

TEST(Sidak, LimitIsTheTwoSidedQuantile) {
  EXPECT_NEAR(sidak_limit(0.05, 1), 1.959963984540054, 1e-13);
  for (std::size_t tests : {10u, 1000u, 196608u}) {
    const double tail = 2 * normal_cdf(-sidak_limit(0.01, tests));
    EXPECT_NEAR(1 - std::exp(double(tests) * std::log1p(-tail)), 0.01, 1e-11) << tests;
  }
}

}  // namespace
}  // namespace penumbra::statistics
