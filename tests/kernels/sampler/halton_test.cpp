// Halton points: radical inverses, permuted digits, and the bases of the pairs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>

#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/sampler_points.h"

namespace penumbra {
namespace {

/// The radical inverse, its digits reversed as integers.
double exact_radical_inverse(std::uint32_t index, std::uint32_t base) {
  long double numerator = 0, denominator = 1;
  for (; index > 0; index /= base) {
    numerator = numerator * base + index % base;
    denominator *= base;
  }
  return double(numerator / denominator);
}

TEST(HaltonSampler, RadicalInverses) {
  // Each digit adds a product with one rounded weight and a rounded sum: at most 32 digits, but their weights
  // fall geometrically, so that 4 roundings of numbers up to 1 bound them all.
  constexpr double kTolerance = 4 * 0x1p-24;
  EXPECT_EQ(radical_inverse(0, 2), 0.0f);
  EXPECT_EQ(radical_inverse(6, 2), 0.375f);  // 110 -> .011
  RandomNumbers random(6);
  for (std::uint32_t base : {2u, 3u, 5u, 7u, 13u, 29u, 53u}) {
    for (std::uint32_t i = 0; i < 2000; ++i)
      ASSERT_NEAR(radical_inverse(i, base), exact_radical_inverse(i, base), kTolerance)
          << i << " base " << base;
    for (int i = 0; i < 2000; ++i) {
      const auto index = std::uint32_t(random.next());
      ASSERT_NEAR(radical_inverse(index, base), exact_radical_inverse(index, base), kTolerance) << index;
    }
  }
}

TEST(HaltonSampler, IsARotatedHaltonSequence) {
  constexpr double kTolerance = 8 * 0x1p-24;
  const std::uint32_t primes[] = {2, 3, 5, 7, 11, 13, 17, 19};
  for (std::uint32_t pair = 0; pair < 4; ++pair) {
    const Point2 first = draw_alone(SAMPLER_HALTON, {1, 4, 5, 0, pair, 16});
    for (std::uint32_t i = 1; i < 500; ++i) {
      const Point2 p = draw_alone(SAMPLER_HALTON, {1, 4, 5, i, pair, 16});
      const auto rotation_error = [](double value, double start, double inverse) {
        const double turns = value - start - inverse;
        return std::abs(turns - std::round(turns));
      };
      EXPECT_LT(rotation_error(p.u, first.u, exact_radical_inverse(i, primes[2 * pair])), kTolerance);
      EXPECT_LT(rotation_error(p.v, first.v, exact_radical_inverse(i, primes[2 * pair + 1])), kTolerance);
    }
  }
}

TEST(HaltonSampler, PermutedDigitsFillEveryIntervalOnce) {
  for (const std::uint32_t base : {2u, 3u, 59u, 311u})
    for (const std::uint32_t seed : {0u, 1u, 0x9e3779b9u}) {
      // The first digits of b^k indices in a row, or of any such aligned block, are all numbers of k digits.
      const std::uint32_t count = base < 10 ? base * base * base : base;
      for (const std::uint32_t first : {0u, 7u * count}) {
        std::set<std::uint32_t> cells;
        for (std::uint32_t i = 0; i < count; ++i) {
          const float x = permuted_inverse(first + i, base, seed);
          ASSERT_GE(x, 0);
          ASSERT_LT(x, 1);
          // What lies below the digits is the same for all: half of its ulp keeps rounding from the cell
          // before.
          cells.insert(std::uint32_t((double(x) + 0x1p-24) * count));
        }
        EXPECT_EQ(cells.size(), count) << base << " from " << first;
      }
    }
}

/// Points of large bases as they are lie on few lines.
TEST(HaltonSampler, LargeBasesAreNotCorrelated) {
  constexpr int kPoints = 64, kPixels = 400;
  double products = 0;
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel)
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const Point2 p = draw_alone(SAMPLER_HALTON, {1, pixel, 5, i, 20, kPoints});
      products += (double(p.u) - 0.5) * (double(p.v) - 0.5);
    }
  // Mean 0; 1/144 is the variance of a product of independent ones, and a pixel's points are no worse.
  EXPECT_LT(std::abs(products / (kPoints * kPixels)), 4 / (12 * std::sqrt(double(kPoints) * kPixels)));
}

TEST(HaltonSampler, EachPairHasItsOwnBases) {
  std::set<uint> places;
  for (const uint pair : {PAIR_FILM, PAIR_LENS, PAIR_CHANNEL, PAIR_TIME})
    EXPECT_TRUE(places.insert(halton_place(pair)).second);
  for (uint pair = 1; pair + 3 < HALTON_PAIRS; ++pair) EXPECT_TRUE(places.insert(halton_place(pair)).second);
  EXPECT_EQ(places.size(), std::size_t(HALTON_PAIRS));
  EXPECT_EQ(*places.rbegin(), uint(HALTON_PAIRS - 1));
  for (const uint base : halton_bases)
    for (uint d = 2; d * d <= base; ++d) EXPECT_NE(base % d, 0u) << base;
}

}  // namespace
}  // namespace penumbra
