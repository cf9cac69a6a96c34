#include "scheduler/image/metrics/error_metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scheduler/image/metrics/compensated_sum.h"
#include "tests/scheduler/image/metrics/small_images.h"

namespace penumbra {
namespace {

using ::testing::DoubleEq;
using ::testing::ElementsAre;

// d: (1, 0, -2) and (0, 0, 0.5).
ImagePair two_pixels() {
  return pair_of(image_of(2, 1, {2, 3, 1, 0, 0, 0.5f}), image_of(2, 1, {1, 3, 3, 0, 0, 0}));
}

TEST(CompensatedSum, KeepsWhatPlainSumsLose) {
  CompensatedSum sum;
  for (const double term : {1.0, 1e100, 1.0, -1e100}) sum.add(term);
  EXPECT_EQ(sum.value(), 2);
  CompensatedSum tenths;
  for (int i = 0; i < 1'000'000; ++i) tenths.add(0.1);
  EXPECT_DOUBLE_EQ(tenths.value(), 1e5);
  CompensatedSum infinite;
  infinite.add(INFINITY);
  infinite.add(1);
  EXPECT_EQ(infinite.value(), INFINITY);
}

TEST(ErrorMetrics, OfBlocks) {
  // One block with errors +1 and -1 has none; another has 3 on one of its 16 pixels.
  std::vector<float> values(32, 2.0f);
  values[0] = 3;
  values[9] = 1;
  values[20] = 5;
  const ImagePair pair = pair_of(grey_image(8, 4, values), grey_image(8, 4, std::vector<float>(32, 2.0f)));
  EXPECT_DOUBLE_EQ(relative_mse(pair).overall, 11 / 4.01 / 32);
  EXPECT_NEAR(block_relative_mse(pair).overall, std::pow(3.0 / 16, 2) / 4.01 / 2, 1e-9);
}

TEST(ErrorMetrics, ByHand) {
  const ImagePair pair = two_pixels();
  const ChannelValues mse = mean_squared_error(pair);
  EXPECT_DOUBLE_EQ(mse.overall, (1 + 4 + 0.25) / 6);
  EXPECT_THAT(mse.channels, ElementsAre(0.5, 0, 2.125));
  const ChannelValues relative = relative_mse(pair);
  EXPECT_DOUBLE_EQ(relative.overall, (1 / 1.01 + 4 / 9.01 + 0.25 / 0.01) / 6);
  EXPECT_THAT(relative.channels, ElementsAre(DoubleEq(0.5 / 1.01), 0, DoubleEq((4 / 9.01 + 25) / 2)));
  EXPECT_DOUBLE_EQ(relative_mse(pair, 1).overall, (1 / 2.0 + 4 / 10.0 + 0.25) / 6);
  EXPECT_DOUBLE_EQ(mean_absolute_percentage_error(pair).overall, (1 / 1.01 + 2 / 3.01 + 0.5 / 0.01) / 6);
  EXPECT_DOUBLE_EQ(symmetric_mean_absolute_percentage_error(pair).overall,
                   (1 / 3.01 + 2 / 4.01 + 0.5 / 0.51) / 6);
  EXPECT_THAT(bias(pair).channels, ElementsAre(0.5, 0, -0.75));
  EXPECT_DOUBLE_EQ(bias(pair).overall, -0.25 / 3);
  EXPECT_THAT(relative_bias(pair).channels, ElementsAre(1, 0, -0.5));
  EXPECT_DOUBLE_EQ(relative_bias(pair).overall, -0.5 / 7);
  EXPECT_THAT(image_mean(pair).channels, ElementsAre(1, 1.5, 0.75));
  EXPECT_THAT(reference_mean(pair).channels, ElementsAre(0.5, 1.5, 1.5));
  EXPECT_THAT(largest_differences(pair).channels, ElementsAre(1, 0, 2));
  EXPECT_EQ(largest_differences(pair).overall, 2);
  EXPECT_DOUBLE_EQ(peak_signal_to_noise_ratio(pair).overall, 10 * std::log10(9 / (5.25 / 6)));
  EXPECT_DOUBLE_EQ(peak_signal_to_noise_ratio(pair).channels[0], 10 * std::log10(1 / 0.5));
}

TEST(ErrorMetrics, NegativeValuesCountByMagnitude) {
  const ImagePair pair = pair_of(grey_image(1, 1, {-1}), grey_image(1, 1, {1}));
  EXPECT_DOUBLE_EQ(symmetric_mean_absolute_percentage_error(pair).overall, 2 / 2.01);
  EXPECT_DOUBLE_EQ(
      mean_absolute_percentage_error(pair_of(grey_image(1, 1, {1}), grey_image(1, 1, {-1}))).overall,
      2 / 1.01);
  EXPECT_DOUBLE_EQ(bias(pair).overall, -2);
}

TEST(ErrorMetrics, TheLargestDifferenceIsInFilmCoordinates) {
  Image image = image_of(2, 2, std::vector<float>(12)), reference = image;
  image.data = reference.data = {10, 20, 2, 2};
  image.values[2 * 3 + 1] = -4;  // pixel 0,1, green
  const LargestDifference largest = largest_difference(pair_of(image, reference));
  EXPECT_EQ(largest.value, 4);
  EXPECT_EQ(largest.x, 10);
  EXPECT_EQ(largest.y, 21);
  EXPECT_EQ(largest.channel, 1u);
}

TEST(ErrorMetrics, EqualImagesDifferByNothing) {
  const Image image = image_of(2, 2, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0});
  const ImagePair pair = pair_of(image, image);
  for (const auto& metric : {mean_squared_error(pair), relative_mse(pair, 0), trimmed_relative_mse(pair, 0),
                             bias(pair), relative_bias(pair), mean_absolute_percentage_error(pair, 0),
                             symmetric_mean_absolute_percentage_error(pair, 0), largest_differences(pair)}) {
    EXPECT_EQ(metric.overall, 0);
    EXPECT_THAT(metric.channels, ElementsAre(0, 0, 0));
  }
  EXPECT_EQ(peak_signal_to_noise_ratio(pair).overall, INFINITY);
}

TEST(ErrorMetrics, TheSecondImageIsTheReference) {
  const Image dark = image_of(1, 1, {0, 0, 0}), bright = image_of(1, 1, {1, 1, 1});
  EXPECT_DOUBLE_EQ(relative_mse(pair_of(bright, dark)).overall, 100);
  EXPECT_DOUBLE_EQ(relative_mse(pair_of(dark, bright)).overall, 1 / 1.01);
}

TEST(ErrorMetrics, TrimmingLeavesOutTheLargestTermsOnly) {
  std::vector<float> values(2000, 1.0f), reference(2000, 0.0f);
  values[7] = 1000;
  values[1500] = -2000;
  values[3] = 10;  // the third largest: stays
  const ImagePair pair = pair_of(grey_image(100, 20, values), grey_image(100, 20, reference));
  EXPECT_EQ(trimmed_pixels(pair), 2u);
  EXPECT_DOUBLE_EQ(trimmed_relative_mse(pair, 1).overall, (1997 * 1 + 100) / 1998.0);
  EXPECT_DOUBLE_EQ(relative_mse(pair, 1).overall, (1997 * 1 + 100 + 1e6 + 4e6) / 2000.0);
  // A share of the pixels that count: of 1999, one.
  values[0] = std::numeric_limits<float>::quiet_NaN();
  const ImagePair one_less = pair_of(grey_image(100, 20, values), grey_image(100, 20, reference));
  EXPECT_EQ(trimmed_pixels(one_less), 1u);
  EXPECT_DOUBLE_EQ(trimmed_relative_mse(one_less, 1).overall, (1996 * 1 + 100 + 1e6) / 1998.0);
  // Ties: any of them may go.
  EXPECT_DOUBLE_EQ(trimmed_relative_mse(pair, 1, 0.5).overall, 1);
  // Too few pixels for one in a thousand: nothing goes.
  EXPECT_DOUBLE_EQ(trimmed_relative_mse(two_pixels()).overall, relative_mse(two_pixels()).overall);
}

TEST(ErrorMetrics, TrimmingIsByPixelOverallAndByChannelForChannels) {
  std::vector<float> values(3 * 1000), reference(3 * 1000);
  values[0] = 3;      // pixel 0, red: mean of its terms 3
  values[3 + 1] = 4;  // pixel 1, green: 16 / 3
  const ImagePair pair = pair_of(image_of(1000, 1, values), image_of(1000, 1, reference));
  const ChannelValues trimmed = trimmed_relative_mse(pair, 1);
  EXPECT_DOUBLE_EQ(trimmed.overall, 3 / 999.0);  // without pixel 1
  EXPECT_THAT(trimmed.channels, ElementsAre(0, 0, 0));
}

// Against long double, at the ends of the range of float.
TEST(ErrorMetrics, ExtremeRadianceGivesTheRightNumbers) {
  for (const double scale : {1e-37, 1e-20, 1.0, 1e20, 1e37}) {
    std::vector<float> values, reference;
    long double square = 0, relative = 0, absolute = 0, sum = 0;
    for (int i = 0; i < 3000; ++i) {
      values.push_back(float(scale * hashed(std::uint64_t(i), 1)));
      reference.push_back(float(scale * hashed(std::uint64_t(i), 2)));
      const long double d = (long double)values.back() - reference.back(), r = reference.back();
      square += d * d;
      sum += d;
      relative += d == 0 ? 0 : d * d / (r * r);
      absolute += d == 0 ? 0 : std::abs(d) / std::abs(r);
    }
    const ImagePair pair = pair_of(image_of(50, 20, values), image_of(50, 20, reference));
    const auto same = [](double actual, long double expected) {
      EXPECT_NEAR(actual, double(expected), 1e-14 * std::abs(double(expected)));
    };
    same(mean_squared_error(pair).overall, square / 3000);
    same(relative_mse(pair, 0).overall, relative / 3000);
    same(mean_absolute_percentage_error(pair, 0).overall, absolute / 3000);
    // Differences of either sign cancel: relative to what is summed.
    EXPECT_NEAR(bias(pair).overall, double(sum / 3000), 1e-15 * scale);
    EXPECT_TRUE(std::isfinite(peak_signal_to_noise_ratio(pair).overall));
    EXPECT_TRUE(std::isfinite(trimmed_relative_mse(pair).overall));
  }
}

TEST(ErrorMetrics, AFireflyDoesNotHideTheRest) {
  // 1e20 and its opposite cancel in the mean; 2e5 values of 1 are below their rounding.
  std::vector<float> values(200'000, 1.0f);
  values[10] = 1e20f;
  values[100'000] = -1e20f;
  const ImagePair pair =
      pair_of(grey_image(1000, 200, values), grey_image(1000, 200, std::vector<float>(200'000, 0.0f)));
  EXPECT_DOUBLE_EQ(bias(pair).overall, 199'998 / 2e5);
}

TEST(ErrorMetrics, WithoutEpsilonBlackReferencesAreInfinitelyWrong) {
  const ImagePair pair = pair_of(grey_image(2, 1, {1, 0}), grey_image(2, 1, {0, 0}));
  EXPECT_EQ(relative_mse(pair, 0).overall, INFINITY);
  EXPECT_EQ(mean_absolute_percentage_error(pair, 0).overall, INFINITY);
  EXPECT_EQ(symmetric_mean_absolute_percentage_error(pair, 0).overall, 0.5);
}

TEST(ErrorMetrics, NonFinitePixelsAreLeftOut) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const ImagePair pair =
      pair_of(image_of(3, 1, {1, 0, 0, 9, kNan, 9, 3, 0, 0}), image_of(3, 1, {0, 0, 0, 1, 1, 1, 0, 0, 0}));
  EXPECT_DOUBLE_EQ(mean_squared_error(pair).overall, 10.0 / 6);
  EXPECT_EQ(largest_difference(pair).x, 2);
  EXPECT_DOUBLE_EQ(image_mean(pair).channels[0], 2);
  EXPECT_DOUBLE_EQ(peak_signal_to_noise_ratio(pair).channels[0], -INFINITY);  // black
}

TEST(ErrorMetrics, MutationsAreSeen) {
  const ImagePair pair = two_pixels();
  for (std::size_t i = 0; i < pair.image.size(); ++i) {
    ImagePair mutated = pair;
    mutated.image[i] += 0.125f;
    EXPECT_NE(mean_squared_error(mutated).channels[i % 3], mean_squared_error(pair).channels[i % 3]);
    EXPECT_NE(relative_mse(mutated).overall, relative_mse(pair).overall);
    EXPECT_DOUBLE_EQ(bias(mutated).channels[i % 3], bias(pair).channels[i % 3] + 0.0625);
  }
}

// Truth 1, image noise s = 0.1, reference noise t = 0.3 each: plain MSE against one reference is s^2 + t^2;
// with two it is s^2, and the standard error of the mean of N products is sqrt(2 s^4 + 2 s^2 t^2 ... ) /
// sqrt(N), which is below sqrt(s^2 + t^2)^2 / sqrt(N).
TEST(ErrorMetrics, TwoReferencesCancelTheirNoise) {
  constexpr int kSide = 300;
  constexpr double kS = 0.1, kT = 0.3;
  const std::vector<double> truth(kSide * kSide, 1.0);
  const Image image = grey_image(kSide, kSide, noisy(truth, kS, 1));
  const Image first = grey_image(kSide, kSide, noisy(truth, kT, 2));
  const Image second = grey_image(kSide, kSide, noisy(truth, kT, 3));
  const double tolerance = 4 * (kS * kS + kT * kT) / kSide;
  EXPECT_NEAR(mean_squared_error(pair_of(image, first)).overall, kS * kS + kT * kT,
              tolerance * std::sqrt(2.0));
  const auto halves = pair_images(image, first, &second);
  ASSERT_TRUE(halves);
  EXPECT_NEAR(mean_squared_error(*halves).overall, kS * kS, tolerance);
  EXPECT_GT(mean_squared_error(pair_of(image, first)).overall, 9 * mean_squared_error(*halves).overall);
  // The reference that relative metrics divide by is the mean of both.
  EXPECT_DOUBLE_EQ(reference_mean(*halves).overall, 0.5 * (image_mean(pair_of(first, first)).overall +
                                                           image_mean(pair_of(second, second)).overall));
}

TEST(ErrorMetrics, TwoReferencesByHand) {
  const Image a = grey_image(1, 1, {5}), b = grey_image(1, 1, {1}), c = grey_image(1, 1, {2});
  const auto pair = pair_images(a, b, &c);
  ASSERT_TRUE(pair);
  EXPECT_DOUBLE_EQ(mean_squared_error(*pair).overall, 4 * 3);
  EXPECT_DOUBLE_EQ(relative_mse(*pair).overall, 12 / (2.25 + 0.01));
  EXPECT_DOUBLE_EQ(bias(*pair).overall, 3.5);
  EXPECT_DOUBLE_EQ(largest_difference(*pair).value, 3.5);
}

}  // namespace
}  // namespace penumbra
