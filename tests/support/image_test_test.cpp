// Tests the image test on images of known noise: correct images pass, slightly wrong ones fail.
#include "tests/support/image_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/support/normal_deviates.h"

namespace penumbra::statistics::image_test_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kSize = 64;

/// A smooth picture; noise and error of a pixel grow with its value.
double truth(int x, int y, int c) { return 0.1 + 0.01 * x + 0.02 * c + 0.005 * y; }

Image noisy_image(std::mt19937_64& random, double noise, double bias = 0) {
  Image image(kSize, kSize, 3);
  NormalDeviates normal;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      for (int c = 0; c < 3; ++c) {
        image.at(x, y, c) = truth(x, y, c) * (1 + bias + noise * normal(random));
      }
    }
  }
  return image;
}

Estimate noisy_estimate(std::mt19937_64& random, int batches, double noise, double bias = 0) {
  std::vector<Image> images;
  for (int i = 0; i < batches; ++i) images.push_back(block_average(noisy_image(random, noise, bias), 4));
  return estimate_from_batches(images);
}

TEST(BlockAverage, MeansOfSquares) {
  Image image(4, 2, 2);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) {
      image.at(x, y, 0) = x + 10 * y;
      image.at(x, y, 1) = 1;
    }
  }
  const Image blocks = block_average(image, 2);
  ASSERT_EQ(blocks.width, 2);
  ASSERT_EQ(blocks.height, 1);
  EXPECT_DOUBLE_EQ(blocks.at(0, 0, 0), 5.5);
  EXPECT_DOUBLE_EQ(blocks.at(1, 0, 0), 7.5);
  EXPECT_DOUBLE_EQ(blocks.at(1, 0, 1), 1);
  EXPECT_DOUBLE_EQ(channel_mean(image, 0), 6.5);
  EXPECT_THROW(block_average(image, 3), std::invalid_argument);
}

TEST(EstimateFromBatches, MeanAndStandardError) {
  std::vector<Image> batches(3, Image(1, 1, 1));
  batches[0].values = {1};
  batches[1].values = {2};
  batches[2].values = {6};
  const Estimate estimate = estimate_from_batches(batches);
  EXPECT_DOUBLE_EQ(estimate.mean.values[0], 3);
  EXPECT_NEAR(estimate.standard_error.values[0], std::sqrt(7.0 / 3), 1e-15) << "variance 14/2, three batches";
  EXPECT_EQ(estimate.dof, 2);
  EXPECT_THROW(estimate_from_batches({batches.data(), 1}), std::invalid_argument);
  batches[1] = Image(2, 1, 1);
  EXPECT_THROW(estimate_from_batches(batches), std::invalid_argument);
}

TEST(ImageZTest, SameImagePassesAndItsSquaresAverageOne) {
  std::mt19937_64 random(11);
  for (int batches : {3, 4, 8, 32}) {
    const ImageTestResult result =
        z_test(noisy_estimate(random, batches, 0.2), noisy_estimate(random, 100, 0.05));
    EXPECT_TRUE(result.passed) << batches << " batches: " << result.summary();
    EXPECT_EQ(result.count, 16u * 16 * 3);
    EXPECT_NEAR(result.mean_square, 1, 4 * std::sqrt(2.0 / double(result.count))) << batches << " batches";
  }
}

TEST(ImageZTest, OneValueOutsideTheLimitIsAsRareAsNominal) {
  // The limit promises that a right image has any value outside it once in a hundred, for few batches too.
  std::mt19937_64 random(12);
  constexpr int kTrials = 400;
  int alarms = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Estimate exact = noisy_estimate(random, 2, 0);
    exact.dof = kInfinity;
    alarms += z_test(noisy_estimate(random, 4, 0.2), exact).accepted_fraction < 1;
  }
  EXPECT_LE(alarms, 12) << "expected 4; more than 12 happens once in ten thousand seeds";
}

TEST(ImageZTest, FindsABiasOfOnePercent) {
  std::mt19937_64 random(13);
  const ImageTestResult result =
      z_test(noisy_estimate(random, 8, 0.05, 0.01), noisy_estimate(random, 100, 0.01));
  EXPECT_FALSE(result.passed) << result.summary();
  EXPECT_GT(result.mean_square, 1.5);
}

TEST(ImageZTest, FindsAFewWrongBlocks) {
  std::mt19937_64 random(14);
  Estimate ours = noisy_estimate(random, 8, 0.05);
  for (int x : {3, 4, 5}) ours.mean.at(x, 7, 1) *= 1.5;
  const ImageTestResult result = z_test(ours, noisy_estimate(random, 100, 0.01));
  EXPECT_FALSE(result.passed) << result.summary();
  EXPECT_EQ(result.worst_y, 7);
  EXPECT_EQ(result.worst_channel, 1);
}

TEST(ImageZTest, ErrorsThatAreTooSmallShow) {
  std::mt19937_64 random(15);
  Estimate ours = noisy_estimate(random, 16, 0.1);
  for (double& error : ours.standard_error.values) error *= 0.8;
  const ImageTestResult result = z_test(ours, noisy_estimate(random, 1000, 0.01));
  EXPECT_FALSE(result.passed) << result.summary();
}

TEST(ImageZTest, KnownDifferencesMayBeSetAsideButNotMore) {
  std::mt19937_64 random(16);
  const Estimate exact = noisy_estimate(random, 1000, 0.01);
  Estimate ours = noisy_estimate(random, 16, 0.1);
  // 8 values, 1000 times the noise off.
  for (int x = 0; x < 8; ++x) ours.mean.at(x, 3, 0) += 100;
  const double share = 8.5 / double(ours.mean.values.size());
  const ImageTestLimits all{.accepted_fraction = 0.9}, most{.accepted_fraction = 0.9, .set_aside = share},
      fewer{.accepted_fraction = 0.9, .set_aside = 0.5 * share};
  EXPECT_FALSE(z_test(ours, exact, all).passed);
  EXPECT_FALSE(z_test(ours, exact, fewer).passed);
  EXPECT_TRUE(z_test(ours, exact, most).passed) << z_test(ours, exact, most).summary();
}

TEST(ImageZTest, ExactValues) {
  const Estimate exact{.mean = Image(8, 8, 1), .standard_error = Image(8, 8, 1), .dof = kInfinity};
  EXPECT_TRUE(z_test(exact, exact).passed);
  Estimate other = exact;
  other.mean.at(2, 3, 0) = 1e-9;
  EXPECT_FALSE(z_test(exact, other).passed) << "no error is claimed, so none is allowed";
  other.mean.at(2, 3, 0) = std::nan("");
  EXPECT_FALSE(z_test(exact, other).passed);
  other.mean = Image(4, 8, 1);
  EXPECT_THROW(z_test(exact, other), std::invalid_argument);
}

}  // namespace
}  // namespace penumbra::statistics::image_test_test
