#include "scheduler/image/metrics/distributions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/statistics.h"

namespace penumbra {
namespace {

TEST(Distributions, NormalTailsAreThoseOfTables) {
  EXPECT_NEAR(normal_two_sided_p(1.959963984540054), 0.05, 1e-15);
  EXPECT_NEAR(normal_two_sided_p(-2.5758293035489004), 0.01, 1e-15);
  EXPECT_EQ(normal_two_sided_p(0), 1);
  EXPECT_NEAR(normal_two_sided_p(10) / 1.523970604832105e-23, 1, 1e-12);
}

TEST(Distributions, ChiSquareWithOneDegreeIsTheSquareOfANormal) {
  for (double z = 0.1; z < 30; z *= 1.3) {
    const double expected = normal_two_sided_p(z);
    EXPECT_NEAR(chi_square_p(z * z, 1), expected, 1e-11 * expected + 1e-15) << z;
  }
}

TEST(Distributions, ChiSquareWithTwoDegreesIsExponential) {
  for (double x = 0.01; x < 1000; x *= 1.7) {
    const double expected = std::exp(-x / 2);
    EXPECT_NEAR(chi_square_p(x, 2), expected, 1e-11 * expected + 1e-15) << x;
  }
}

// SciPy 1.17's chi2.sf.
TEST(Distributions, ChiSquareAgreesWithScipy) {
  const struct {
    double x, dof, p;
  } kCases[] = {{255.2, 256, 0.5023602316931541},
                {400, 256, 2.094601605403981e-08},
                {1005000, 1e6, 0.00020767800946702958},
                {1200, 1000, 1.2255942330622893e-05},
                {0.5, 3, 0.9188914116546758}};
  for (const auto& c : kCases) EXPECT_NEAR(chi_square_p(c.x, c.dof) / c.p, 1, 1e-8) << c.x;
  EXPECT_LT(chi_square_p(5000, 256), 1e-300);
  for (double dof = 1; dof < 1e5; dof *= 3.7) {
    for (const double part : {0.5, 0.9, 1.0, 1.1, 1.5}) {
      const double other = statistics::chi_square_p(part * dof, dof);
      EXPECT_NEAR(chi_square_p(part * dof, dof), other, 1e-9 * other + 1e-14) << dof << " " << part;
    }
  }
}

TEST(Distributions, EndsOfTheRange) {
  EXPECT_EQ(chi_square_p(0, 5), 1);
  EXPECT_EQ(chi_square_p(INFINITY, 5), 0);
  EXPECT_TRUE(std::isnan(chi_square_p(NAN, 5)));
  // Images that differ by roundings.
  for (const double x : {1e-300, 1e-20, 1e-9, 1e-3})
    for (const double dof : {20.0, 768.0, 1e4, 2e5, 1e7})
      EXPECT_EQ(chi_square_p(x, dof), 1) << x << " " << dof;
}

}  // namespace
}  // namespace penumbra
