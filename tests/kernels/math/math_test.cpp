// The elementary functions against the C library's in double, over the ranges and within the errors that
// kernels/math/math.h states.
#include "kernels/math/math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/kernels/random_numbers.h"

namespace penumbra::math_test {
namespace {

constexpr float kSmallestNormal = std::numeric_limits<float>::min();
constexpr float kLargest = std::numeric_limits<float>::max();

/// The largest error seen and where, for messages.
struct WorstError {
  double error = 0;
  float at = 0, at_second = 0;

  void add(double e, float x, float second = 0) {
    if (std::isnan(error) || e <= error) return;  // a NaN is kept
    error = e;
    at = x;
    at_second = second;
  }
  /// `got` against `truth`, relative to the truth; an exact 0 must be met exactly.
  void add_relative(double got, double truth, float x, float second = 0) {
    add(truth == 0 ? (got == 0 ? 0 : 1) : std::abs(got - truth) / std::abs(truth), x, second);
  }
};

#define EXPECT_WORST(worst, limit) \
  EXPECT_LT((worst).error, limit) << "at " << (worst).at << ", " << (worst).at_second

/// Calls visit(x) for floats of [low, high], 0 <= low: every `stride`-th bit pattern, so each binade as
/// densely.
template <typename Visit>
void for_floats(float low, float high, std::uint32_t stride, Visit visit) {
  const auto last = std::bit_cast<std::uint32_t>(high);
  for (std::uint64_t bits = std::bit_cast<std::uint32_t>(low); bits <= last; bits += stride)
    visit(std::bit_cast<float>(std::uint32_t(bits)));
  visit(high);
}

/// Calls visit(x) for equally spaced x in [low, high].
template <typename Visit>
void for_steps(double low, double high, int steps, Visit visit) {
  for (int i = 0; i <= steps; ++i) visit(float(low + (high - low) * i / steps));
}

// A prime stride, so that low bits of the mantissa vary.
constexpr std::uint32_t kStride = 997;

TEST(Math, SineAndCosineOfTurns) {
  WorstError sine, cosine, square;
  const auto check = [&](float u) {
    float s, c;
    sincos_2pi(u, &s, &c);
    const double angle = 2 * std::numbers::pi * u;  // rounded by less than 1e-15
    sine.add(std::abs(s - std::sin(angle)), u);
    cosine.add(std::abs(c - std::cos(angle)), u);
    square.add(std::abs(double(s) * s + double(c) * c - 1), u);
  };
  for_steps(-2, 2, 2'000'000, check);
  for_floats(0, 2, 9973, [&](float u) {
    check(u);
    check(-u);
  });
  EXPECT_WORST(sine, 1.2e-7);
  EXPECT_WORST(cosine, 1.2e-7);
  EXPECT_WORST(square, 2 * std::numbers::sqrt2 * 1.2e-7);  // 2 (s ds + c dc)
}

TEST(Math, QuarterTurnsAreExact) {
  const float sines[] = {0, 1, 0, -1}, cosines[] = {1, 0, -1, 0};
  for (int k = -8; k <= 8; ++k) {
    float s, c;
    sincos_2pi(0.25f * float(k), &s, &c);
    EXPECT_EQ(s, sines[k & 3]) << k;
    EXPECT_EQ(c, cosines[k & 3]) << k;
  }
}

TEST(Math, Exponential) {
  WorstError worst;
  const auto check = [&](float x) { worst.add_relative(exp_f(x), std::exp(double(x)), x); };
  for_steps(-87.3, 88, 2'000'000, check);
  for_floats(0, 88, kStride * 7, check);
  for_floats(0, 87.3f, kStride * 7, [&](float x) { check(-x); });
  EXPECT_WORST(worst, 2.6e-7);
}

TEST(Math, ExponentialOutsideItsRange) {
  EXPECT_EQ(exp_f(0.0f), 1.0f);
  EXPECT_EQ(exp_f(-0.0f), 1.0f);
  for (float x : {-87.31f, -100.0f, -1e4f, -1e30f, -kLargest, -std::numeric_limits<float>::infinity()})
    EXPECT_EQ(exp_f(x), 0.0f) << x;
  for (float x : {88.0f, 89.0f, 1e4f, kLargest, std::numeric_limits<float>::infinity()})
    EXPECT_EQ(exp_f(x), exp_f(88.0f)) << x;
  EXPECT_TRUE(std::isfinite(exp_f(88.0f)));
}

TEST(Math, Logarithm) {
  WorstError worst;
  const auto check = [&](float x) { worst.add_relative(log_f(x), std::log(double(x)), x); };
  for_floats(kSmallestNormal, kLargest, kStride, check);
  for_floats(0.5f, 2.0f, 13, check);  // where it crosses 0
  EXPECT_WORST(worst, 2.3e-7);
  EXPECT_EQ(log_f(1.0f), 0.0f);
}

TEST(Math, LogarithmOfOnePlus) {
  WorstError worst;
  const auto check = [&](float x) { worst.add_relative(log1p_f(x), std::log1p(double(x)), x); };
  for_floats(kSmallestNormal, 1e30f, kStride, check);
  for_floats(kSmallestNormal, 0.25f, kStride, [&](float x) { check(-x); });
  EXPECT_WORST(worst, 3e-7);
  EXPECT_EQ(log1p_f(0.0f), 0.0f);
  // Below -1/4 the sum 1 + x is exact (Sterbenz), so this side is as good.
  WorstError negative;
  for_floats(0.25f, 0.99999994f, 5,
             [&](float x) { negative.add_relative(log1p_f(-x), std::log1p(-double(x)), -x); });
  EXPECT_WORST(negative, 3e-7);
}

TEST(Math, ExponentialMinusOne) {
  WorstError worst;
  const auto check = [&](float x) { worst.add_relative(expm1_f(x), std::expm1(double(x)), x); };
  for_floats(kSmallestNormal, 88.0f, kStride, check);
  for_floats(kSmallestNormal, 1e4f, kStride, [&](float x) { check(-x); });
  for_floats(0.3f, 0.4f, 3, [&](float x) {  // either side of the branch
    check(x);
    check(-x);
  });
  EXPECT_WORST(worst, 8e-7);
  EXPECT_EQ(expm1_f(0.0f), 0.0f);
  WorstError near;
  for_floats(kSmallestNormal, 0.349f, kStride, [&](float x) {
    near.add_relative(expm1_f(x), std::expm1(double(x)), x);
    near.add_relative(expm1_f(-x), std::expm1(-double(x)), -x);
  });
  EXPECT_WORST(near, 3e-7);
}

TEST(Math, ArcTangent) {
  WorstError worst;
  const auto check = [&](float y, float x) {
    worst.add_relative(atan2_f(y, x), std::atan2(double(y), double(x)), y, x);
  };
  const auto check_quadrants = [&](float y, float x) {
    for (float sy : {1.0f, -1.0f})
      for (float sx : {1.0f, -1.0f}) check(sy * y, sx * x);
  };
  for_floats(1e-30f, 1e30f, kStride, [&](float y) { check_quadrants(y, 1.0f); });
  for_floats(0.3f, 3.0f, 53, [&](float y) { check_quadrants(y, 1.0f); });
  RandomNumbers random(1);
  for (int i = 0; i < 500'000; ++i) {
    // Either of any magnitude, with quotients that are normal numbers.
    const double scale = std::exp(random.between(-30, 30)), quotient = std::exp(random.between(-30, 30));
    check_quadrants(float(scale * quotient), float(scale));
  }
  EXPECT_WORST(worst, 3e-7);
}

TEST(Math, ArcTangentOnTheAxes) {
  const float pi = float(std::numbers::pi), half = float(std::numbers::pi / 2);
  EXPECT_EQ(atan2_f(0.0f, 0.0f), 0.0f);
  for (float x : {1e-30f, 1.0f, 1e30f}) {
    EXPECT_EQ(atan2_f(0.0f, x), 0.0f);
    EXPECT_EQ(atan2_f(0.0f, -x), pi);
    EXPECT_EQ(atan2_f(x, 0.0f), half);
    EXPECT_EQ(atan2_f(-x, 0.0f), -half);
  }
}

TEST(Math, Constants) {
  EXPECT_EQ(ONE_MINUS_EPSILON, std::nextafter(1.0f, 0.0f));
  EXPECT_EQ(HALF_EPSILON, 0x1p-24f);
  EXPECT_EQ(PI_F, float(std::numbers::pi));
  EXPECT_EQ(INV_PI_F, float(std::numbers::inv_pi));
}

TEST(Math, SmallFunctions) {
  EXPECT_EQ(safe_sqrt(-1e-9f), 0.0f);
  EXPECT_EQ(safe_sqrt(2.25f), 1.5f);
  EXPECT_EQ(sign_of(0.0f), 1.0f);
  EXPECT_EQ(sign_of(-0.0f), 1.0f);
  EXPECT_EQ(sign_of(-1e-30f), -1.0f);
  EXPECT_EQ(clamp_f(3.0f, 0.0f, 2.0f), 2.0f);
  EXPECT_EQ(clamp_f(-3.0f, 0.0f, 2.0f), 0.0f);
}

}  // namespace
}  // namespace penumbra::math_test
