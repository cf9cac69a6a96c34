// The elementary functions in double against the C library's in extended precision, over the ranges and
// within the errors that kernels/math/math_double.h states.
#include "kernels/math/math_double.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/kernels/random_numbers.h"

namespace penumbra::math_double_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargest = std::numeric_limits<double>::max();
constexpr int kSamples = 500'000;

static_assert(std::numeric_limits<long double>::digits >= 64, "extended precision is the truth here");

/// The largest relative error seen and where; an exact 0 must be met exactly.
struct WorstError {
  double error = 0, at = 0, at_second = 0;

  void add(double got, long double truth, double x, double second = 0) {
    const double e = truth == 0 ? (got == 0 ? 0 : 1) : double(std::abs((got - truth) / truth));
    if (std::isnan(error) || e <= error) return;  // a NaN is kept
    error = e;
    at = x;
    at_second = second;
  }
};

#define EXPECT_WORST(worst, limit) \
  EXPECT_LT((worst).error, limit) << "at " << (worst).at << ", " << (worst).at_second

/// A positive number whose logarithm is uniform.
double any_size(RandomNumbers& random, double log_low, double log_high) {
  return std::exp(random.between(log_low, log_high));
}

TEST(MathDouble, Exponential) {
  RandomNumbers random(1);
  WorstError worst;
  const auto check = [&](double x) { worst.add(exp_d(x), std::exp((long double)x), x); };
  for (int i = 0; i < kSamples; ++i) {
    check(random.between(-708, 708));
    check(random.between(-1, 1));
    check((random.below(2) == 0 ? 1 : -1) * any_size(random, -700, 6.5));
  }
  // Where it changes its power of two, and one on either side.
  for (int n = -1020; n <= 1020; ++n) {
    const double x = (n + .5) * std::numbers::ln2;
    check(x);
    check(std::nextafter(x, -kInfinity));
    check(std::nextafter(x, kInfinity));
  }
  check(708);
  check(-708);
  EXPECT_WORST(worst, 2.3e-16);
}

TEST(MathDouble, ExponentialOutsideItsRange) {
  EXPECT_EQ(exp_d(0.0), 1.0);
  EXPECT_EQ(exp_d(-0.0), 1.0);
  for (double x : {-708.1, -1e4, -kLargest, -kInfinity}) EXPECT_EQ(exp_d(x), 0.0) << x;
  for (double x : {708.1, 1e4, kLargest, kInfinity}) EXPECT_EQ(exp_d(x), exp_d(708.0)) << x;
  EXPECT_TRUE(std::isfinite(exp_d(708.0)));
}

TEST(MathDouble, ExponentialAndWhatIsLeftToOne) {
  RandomNumbers random(2);
  WorstError power, rest;
  const auto check = [&](double x) {
    double r;
    power.add(exp_and_rest_d(x, &r), std::exp((long double)x), x);
    rest.add(r, -std::expm1((long double)x), x);
  };
  for (int i = 0; i < kSamples; ++i) {
    check(-any_size(random, -700, 6.5));
    check(random.between(-1, 0));
    check(random.between(-60, 0));
  }
  EXPECT_WORST(power, 2.3e-16);
  EXPECT_WORST(rest, 3.5e-16);
  double r;
  EXPECT_EQ(exp_and_rest_d(0.0, &r), 1.0);
  EXPECT_EQ(r, 0.0);
  for (double x : {-708.1, -1e4, -kLargest, -kInfinity}) {
    EXPECT_EQ(exp_and_rest_d(x, &r), 0.0) << x;
    EXPECT_EQ(r, 1.0) << x;
  }
}

TEST(MathDouble, Logarithm) {
  RandomNumbers random(3);
  WorstError worst;
  const auto check = [&](double x) { worst.add(log_d(x), std::log((long double)x), x); };
  for (int i = 0; i < kSamples; ++i) {
    check(any_size(random, -708, 709));
    check(random.between(0.5, 2));
    check(1 + random.between(-1e-3, 1e-3));
    check(1 + any_size(random, -36, -1));
  }
  for (double x : {SMALLEST_D, kLargest, std::nextafter(1.0, 0.0), std::nextafter(1.0, 2.0)}) check(x);
  for (double half : {std::numbers::sqrt2 / 2, std::numbers::sqrt2, 8 * std::numbers::sqrt2})
    for (double x : {half, std::nextafter(half, 0.0), std::nextafter(half, kInfinity)}) check(x);
  EXPECT_WORST(worst, 5e-16);
  EXPECT_EQ(log_d(1.0), 0.0);
}

TEST(MathDouble, LogarithmOfOnePlus) {
  RandomNumbers random(4);
  WorstError worst;
  const auto check = [&](double x) { worst.add(log1p_d(x), std::log1p((long double)x), x); };
  for (int i = 0; i < kSamples; ++i) {
    check(any_size(random, -708, 709));
    check(-any_size(random, -708, -1e-16));
    check(random.between(-1, 1));
    check(any_size(random, -36, 0) - 1);
  }
  check(0x1p-53 - 1);
  EXPECT_WORST(worst, 6e-16);
  EXPECT_EQ(log1p_d(0.0), 0.0);
}

TEST(MathDouble, ArcTangent) {
  RandomNumbers random(5);
  WorstError worst;
  const auto check = [&](double y, double x) {
    for (double sy : {1.0, -1.0})
      for (double sx : {1.0, -1.0})
        worst.add(atan2_d(sy * y, sx * x), std::atan2((long double)(sy * y), (long double)(sx * x)), y, x);
  };
  for (int i = 0; i < kSamples; ++i) {
    const double scale = any_size(random, -300, 300);
    check(scale * any_size(random, -300, 300), scale);
    check(random.between(0, 4), random.between(0, 4));
  }
  const double eighth = std::numbers::sqrt2 - 1;  // the tangent of pi / 8
  for (double t : {eighth, 1.0, 1 / eighth})
    for (double y : {t, std::nextafter(t, 0.0), std::nextafter(t, kInfinity)}) check(y, 1);
  EXPECT_WORST(worst, 4e-16);
}

TEST(MathDouble, ArcTangentOnTheAxes) {
  const double pi = std::numbers::pi;
  EXPECT_EQ(PI_D, pi);
  EXPECT_EQ(HALF_PI_D, pi / 2);
  EXPECT_EQ(atan2_d(0.0, 0.0), 0.0);
  for (double x : {1e-300, 1.0, 1e300}) {
    EXPECT_EQ(atan2_d(0.0, x), 0.0);
    EXPECT_EQ(atan2_d(0.0, -x), pi);
    EXPECT_EQ(atan2_d(x, 0.0), pi / 2);
    EXPECT_EQ(atan2_d(-x, 0.0), -pi / 2);
    EXPECT_EQ(atan2_d(x, x), pi / 4);
  }
}

TEST(MathDouble, Sine) {
  RandomNumbers random(6);
  WorstError worst;
  const auto check = [&](double x) {
    worst.add(sin_d(x), std::sin((long double)x), x);
    worst.add(sin_d(-x), -std::sin((long double)x), -x);
  };
  for (int i = 0; i < kSamples; ++i) {
    check(random.between(0, 1.55));
    check(any_size(random, -700, 0.438));
  }
  check(1.55);
  EXPECT_WORST(worst, 3e-16);
  EXPECT_EQ(sin_d(0.0), 0.0);
}

TEST(MathDouble, SmallFunctions) {
  EXPECT_EQ(safe_sqrt_d(-1e-9), 0.0);
  EXPECT_EQ(safe_sqrt_d(2.25), 1.5);
  EXPECT_EQ(clamp_d(3.0, 0.0, 2.0), 2.0);
  EXPECT_EQ(clamp_d(-3.0, 0.0, 2.0), 0.0);
}

}  // namespace
}  // namespace penumbra::math_double_test
