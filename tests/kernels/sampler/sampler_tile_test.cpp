// Pixels of a Sobol tile: they are not correlated individually, and the error of their mean is that of one
// long sequence.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "tests/kernels/sampler_points.h"
#include "tests/support/statistics.h"

namespace penumbra::sampler_tile_test {
namespace {

constexpr double kSignificance = 0.01;
constexpr std::uint32_t kTile = 1u << TILE_LEVELS;

/// The address of tile t's pixel x, y: the tiles of an image 32 tiles wide.
SampleAddress in_tile(std::uint32_t t, std::uint32_t x, std::uint32_t y, SampleAddress rest) {
  rest.x = t % 32 * kTile + x;
  rest.y = t / 32 * kTile + y;
  return rest;
}

double p_of_uniform(const std::vector<double>& counts) {
  const double total = std::accumulate(counts.begin(), counts.end(), 0.0);
  return statistics::chi_square_test(counts,
                                     std::vector<double>(counts.size(), total / double(counts.size())))
      .p;
}

TEST(SobolTile, EachPlaceAndSampleIsUniformOverTiles) {
  // Tiles are independent, so over them each pixel's point is a sample of the uniform distribution.
  constexpr std::uint32_t kTiles = 4096;
  constexpr std::size_t kSide = 8;
  std::vector<double> ps;
  for (std::uint32_t place = 0; place < kTile * kTile; place += 5)
    for (std::uint32_t spp : {1u, 3u}) {
      std::vector<double> counts(kSide * kSide);
      for (std::uint32_t t = 0; t < kTiles; ++t) {
        const Point2 p = draw_alone(
            SAMPLER_SOBOL,
            in_tile(t, place % kTile, place / kTile, {.seed = 5, .index = spp - 1, .pair = 1, .spp = spp}));
        ++counts[std::size_t(p.v * kSide) * kSide + std::size_t(p.u * kSide)];
      }
      ps.push_back(p_of_uniform(counts));
    }
  for (double p : ps) EXPECT_GT(p, statistics::sidak_significance(kSignificance, ps.size()));
}

TEST(SobolTile, PairsAreIndependentBetweenItsPixels) {
  // Two pixels of a tile, other pairs of numbers: over tiles uniform on the square, for every distance.
  constexpr std::uint32_t kTiles = 8192;
  constexpr std::size_t kSide = 8;
  std::vector<double> ps;
  for (std::uint32_t apart : {0u, 1u, 2u, 4u, 8u})
    for (std::uint32_t other : {2u, 3u, 5u, 9u}) {
      std::vector<double> uu(kSide * kSide), uv = uu;
      for (std::uint32_t t = 0; t < kTiles; ++t) {
        const SampleAddress rest{.seed = 6, .pair = 1, .spp = 1};
        SampleAddress of_other = in_tile(t, 3 ^ apart, 6, rest);
        of_other.pair = other;
        const Point2 p = draw_alone(SAMPLER_SOBOL, in_tile(t, 3, 6, rest)),
                     q = draw_alone(SAMPLER_SOBOL, of_other);
        ++uu[std::size_t(p.u * kSide) * kSide + std::size_t(q.u * kSide)];
        ++uv[std::size_t(p.u * kSide) * kSide + std::size_t(q.v * kSide)];
      }
      ps.push_back(p_of_uniform(uu));
      ps.push_back(p_of_uniform(uv));
    }
  for (double p : ps) EXPECT_GT(p, statistics::sidak_significance(kSignificance, ps.size()));
}

struct Errors {
  double of_pixels = 0, of_blocks = 0;  ///< mean squares
};

/// Of the means of the smooth integrand over pixels and over the aligned 4 x 4 pixels at their tile's centre.
Errors errors_of(std::uint32_t spp, std::uint32_t tiles) {
  constexpr std::uint32_t kSide = 4, kPixels = kSide * kSide;
  Errors errors;
  for (std::uint32_t t = 0; t < tiles; ++t) {
    double block = 0;
    for (std::uint32_t p = 0; p < kPixels; ++p) {
      double sum = 0;
      for (std::uint32_t i = 0; i < spp; ++i)
        sum += smooth(draw_alone(SAMPLER_SOBOL, in_tile(t, 8 + p % kSide, 4 + p / kSide,
                                                        {.seed = 12, .index = i, .pair = 2, .spp = spp})));
      errors.of_pixels += std::pow(sum / spp - kSmoothTruth, 2) / (kPixels * tiles);
      block += sum / (spp * kPixels);
    }
    errors.of_blocks += std::pow(block - kSmoothTruth, 2) / tiles;
  }
  return errors;
}

TEST(SobolTile, MeansOfPixelsHaveTheErrorOfOneLongSequence) {
  // The mean of 16 pixels of n samples is that of one pixel of 16 n. A mean square of N normal errors has a
  // relative standard deviation of sqrt(2 / N); four of them, of both sides of the ratio. With independent
  // pixels the ratios would be 16^2 and more: errors of this integrand fall as n^-1.5.
  constexpr std::uint32_t kTiles = 600;
  const double tolerance = 4 * std::sqrt(2 * 2.0 / kTiles);
  for (std::uint32_t spp : {1u, 2u, 4u, 16u}) {
    const double block = errors_of(spp, kTiles).of_blocks, long_pixel = errors_of(16 * spp, kTiles).of_pixels;
    EXPECT_NEAR(std::log(block / long_pixel), 0, tolerance) << spp;
  }
}

TEST(SobolTile, PixelsByThemselvesAreNoWorse) {
  // Against the variance of one sample: exact for one sample, and at most that of as many independent ones.
  const double second = std::pow(0.5 * std::sqrt(std::acos(-1.0) / 2) * std::erf(std::sqrt(2.0)), 2);
  const double variance = second - kSmoothTruth * kSmoothTruth;
  constexpr std::uint32_t kTiles = 2000;
  // Pixels of a tile are dependent, so it counts for one; its mean square deviates by at most sqrt(kurtosis -
  // 1) = 1 for a distribution as flat as this.
  EXPECT_NEAR(errors_of(1, kTiles).of_pixels / variance, 1, 4 / std::sqrt(double(kTiles)));
  for (std::uint32_t spp : {2u, 3u, 5u, 8u})
    EXPECT_LT(errors_of(spp, kTiles).of_pixels, variance / spp) << spp;
}

}  // namespace
}  // namespace penumbra::sampler_tile_test
