// Bias and noise are told apart on synthetic images for which both are known.
#include "scheduler/report/seed_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scheduler/image/metrics/error_metrics.h"
#include "tests/support/normal_deviates.h"

namespace penumbra {
namespace {

constexpr int kSide = 64;
constexpr double kPixels = double(kSide) * kSide;
constexpr float kTruth = 2;
/// Standard errors within which an estimate must be; by chance it is not once in 16000.
constexpr double kDeviations = 4;

/// kTruth + bias + noise N, the same in all channels, as that of grey light is; sd in radiance.
Image noisy_image(double bias, double sd, std::mt19937_64& random) {
  NormalDeviates normal;
  Image image{{0, 0, kSide, kSide}, {0, 0, kSide, kSide}, {"R", "G", "B"}, {}, {}};
  for (int i = 0; i < kSide * kSide; ++i)
    image.values.insert(image.values.end(), 3, float(kTruth + bias + sd * normal(random)));
  return image;
}

struct Setting {
  double bias = 0, sd = 0, reference_sd = 0;
  int seeds = 10;
  bool two_references = true;
};

SeedStatistics measure(const Setting& setting, std::uint64_t seed, double* mean_mse = nullptr) {
  std::mt19937_64 random(seed);
  const Image a = noisy_image(0, setting.reference_sd, random),
              b = noisy_image(0, setting.reference_sd, random);
  SeedStatistics statistics;
  for (int i = 0; i < setting.seeds; ++i) {
    const auto pair =
        pair_images(noisy_image(setting.bias, setting.sd, random), a, setting.two_references ? &b : nullptr);
    statistics.add(*pair);
    if (mean_mse != nullptr) *mean_mse += mean_squared_error(*pair).overall / setting.seeds;
  }
  return statistics;
}

TEST(SeedStatistics, TellsBiasFromVariance) {
  const Setting setting{.bias = 0.1, .sd = 0.5, .reference_sd = 0.05};
  double mse = 0;
  const ErrorSplit split = measure(setting, 1, &mse).squared();
  // Values are independent: a value's sample variance over R seeds has the relative deviation sqrt(2 / (R -
  // 1)).
  const double variance_error = 0.25 * std::sqrt(2.0 / 9 / kPixels);
  EXPECT_NEAR(split.variance, 0.25, kDeviations * variance_error);
  EXPECT_GT(split.bias_squared_error, 0);
  EXPECT_LT(split.bias_squared_error, 0.001) << "or this test would not see the bias";
  EXPECT_NEAR(split.bias_squared, 0.01, kDeviations * split.bias_squared_error);
  EXPECT_NEAR(split.error, split.bias_squared + split.variance, 1e-12);
  EXPECT_NEAR(split.error, mse, 1e-9) << "the mean over seeds of what scheduler/metrics says";
}

TEST(SeedStatistics, FindsNoBiasWhereThereIsNone) {
  const ErrorSplit split = measure({.sd = 0.5, .reference_sd = 0.05}, 2).squared();
  EXPECT_NEAR(split.bias_squared, 0, kDeviations * split.bias_squared_error);
}

TEST(SeedStatistics, StandardErrorOfTheBiasIsItsSpread) {
  // Over repeats, (estimate - truth) / standard error has mean 0 and variance 1: chi-square of kRepeats.
  constexpr int kRepeats = 40;
  const Setting settings[] = {{.bias = 0.05, .sd = 0.3, .reference_sd = 0, .seeds = 4},
                              {.bias = 0, .sd = 0.3, .reference_sd = 0, .seeds = 2},
                              {.bias = 0.3, .sd = 0.1, .reference_sd = 0, .seeds = 3},
                              {.bias = 0.1, .sd = 0.1, .reference_sd = 0.1, .seeds = 5}};
  for (const Setting& setting : settings) {
    double sum = 0, squares = 0;
    for (int i = 0; i < kRepeats; ++i) {
      const ErrorSplit split = measure(setting, 100 + i).squared();
      const double z = (split.bias_squared - setting.bias * setting.bias) / split.bias_squared_error;
      sum += z;
      squares += z * z;
    }
    EXPECT_NEAR(sum / kRepeats, 0, kDeviations / std::sqrt(kRepeats)) << setting.seeds;
    EXPECT_NEAR(squares / kRepeats, 1, kDeviations * std::sqrt(2.0 / kRepeats)) << setting.seeds;
  }
}

TEST(SeedStatistics, BiasOfFewPixelsIsClear) {
  // Without noise the bias is known exactly, however unevenly it is spread.
  Image truth{{0, 0, 2, 1}, {0, 0, 2, 1}, {"Y"}, {1, 1}, {}}, image = truth;
  image.values[1] = 3;
  SeedStatistics statistics;
  for (int i = 0; i < 2; ++i) statistics.add(*pair_images(image, truth));
  EXPECT_EQ(statistics.squared().bias_squared, 2);
  EXPECT_EQ(statistics.squared().bias_squared_error, 0);
}

TEST(SeedStatistics, TwoReferencesCancelTheirNoise) {
  const double reference_variance = 0.16;
  Setting setting{.sd = 0.1, .reference_sd = 0.4};
  const ErrorSplit two = measure(setting, 3).squared();
  // (x - A)(x - B) has the noise AB of standard deviation 0.16 per value, and smaller ones.
  const double spread = (reference_variance + 2 * 0.4 * 0.1 + 0.01) / std::sqrt(kPixels);
  EXPECT_NEAR(two.error, 0.01, kDeviations * spread);
  setting.two_references = false;
  const ErrorSplit one = measure(setting, 3).squared();
  EXPECT_NEAR(one.error, 0.01 + reference_variance, kDeviations * 2 * spread);
  EXPECT_NEAR(one.bias_squared, reference_variance, kDeviations * one.bias_squared_error)
      << "one reference's noise is the same in all images, as a bias is";
}

TEST(SeedStatistics, RelativeErrorsAreWeighted) {
  const SeedStatistics statistics = measure({.bias = 0.1, .sd = 0.5}, 4);
  const double weight = 1 / (double(kTruth) * kTruth + 0.01);
  EXPECT_NEAR(statistics.relative(0.01).error, statistics.squared().error * weight, 1e-9);
  EXPECT_NEAR(statistics.relative(0.01).variance, statistics.squared().variance * weight, 1e-9);
}

TEST(SeedStatistics, OneImageHasNoSplit) {
  const ErrorSplit split = measure({.sd = 0.5, .seeds = 1}, 5).squared();
  EXPECT_NEAR(split.error, 0.25, kDeviations * 0.25 * std::sqrt(2 / kPixels));
  EXPECT_TRUE(std::isnan(split.variance));
  EXPECT_TRUE(std::isnan(split.bias_squared));
}

TEST(SeedStatistics, LeavesOutPixelsThatAreNotFiniteInOneImage) {
  std::mt19937_64 random(6);
  const Image truth = noisy_image(0, 0, random);
  Image good = noisy_image(0, 0, random), bad = good;
  for (float& value : good.values) value += 0.5f;
  for (float& value : bad.values) value += 0.5f;
  bad.values[7] = NAN;
  good.values[30] = INFINITY;
  SeedStatistics statistics;
  statistics.add(*pair_images(good, truth));
  statistics.add(*pair_images(bad, truth));
  EXPECT_DOUBLE_EQ(statistics.squared().error, 0.25);
  EXPECT_DOUBLE_EQ(statistics.squared().bias_squared, 0.25);
}

}  // namespace
}  // namespace penumbra
