#include "scheduler/image/metrics/z_test.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/scheduler/image/metrics/small_images.h"
#include "tests/support/statistics.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;

constexpr int kSide = 64;
constexpr float kVarianceA = 0.04f, kVarianceB = 0.01f;
const std::vector<double> kTruth(3 * kSide * kSide, 2.0);

ImagePair noisy_pair(std::uint32_t seed) {
  return pair_of(image_of(kSide, kSide, noisy(kTruth, std::sqrt(kVarianceA), 2 * seed)),
                 image_of(kSide, kSide, noisy(kTruth, std::sqrt(kVarianceB), 2 * seed + 1)));
}

ZTest tested(const ImagePair& pair, double significance = 0.01) {
  const std::vector<float> a(pair.image.size(), kVarianceA), b(pair.image.size(), kVarianceB);
  return z_test(pair, {a, {}}, {b, {}}, {.significance = significance}).value();
}

TEST(ZTest, ByHand) {
  const ImagePair pair = pair_of(image_of(2, 1, {3, 1, 1, 2, 1, 5}), image_of(2, 1, {1, 1, 1, 1, 1, 5}));
  const std::vector<float> a = {0.5f, 1, 0, 0.25f, 1, 0}, b = {0.5f, 0, 0, 0, 0, 0};
  const auto test = z_test(pair, {a, {}}, {b, {}});  // z: 2, 0, none; 2, 0, none
  ASSERT_TRUE(test);
  EXPECT_EQ(test->values, 4u);
  EXPECT_EQ(test->exact_equal, 2u);
  EXPECT_EQ(test->exact_different, 0u);
  EXPECT_NEAR(test->largest.z, 2, 1e-6);
  EXPECT_NEAR(test->largest.p, 4 * 0.04550026389635842, 1e-6);
  EXPECT_DOUBLE_EQ(test->share_above_1_96, 0.5);
  EXPECT_EQ(test->share_above_2_58, 0);
  EXPECT_NEAR(test->mean_square, 2, 1e-6);
  EXPECT_EQ(test->blocks, 2u);  // red, green
  EXPECT_NEAR(test->block_chi_square.z, 8, 1e-5);
  EXPECT_EQ(test->block_chi_square.dof, 2);
  EXPECT_NEAR(test->block_chi_square.p, 2 * std::exp(-4.0), 1e-6);
  EXPECT_NEAR(test->block_mean.z, 3 / std::sqrt(1.25), 1e-5);
  EXPECT_NEAR(test->image_mean.z, 3 / std::sqrt(1.25), 1e-5);
  EXPECT_TRUE(std::isnan(test->channel_mean_z[2]));
}

TEST(ZTest, SharesByHand) {
  const ImagePair pair =
      pair_of(grey_image(5, 1, {1, -2, 2.5f, -2.7f, 0}), grey_image(5, 1, {0, 0, 0, 0, 0}));
  const std::vector<float> one(5, 1.0f);
  const auto test = z_test(pair, {one, {}}, {});
  EXPECT_DOUBLE_EQ(test->share_above_1_96, 0.6);
  EXPECT_DOUBLE_EQ(test->share_above_2_58, 0.2);
}

// The last bit of a value whose variance is far below it.
TEST(ZTest, RoundingIsNoDifference) {
  const ImagePair pair = pair_of(grey_image(1, 1, {std::nextafter(3.0f, 4.0f)}), grey_image(1, 1, {3}));
  const auto test = z_test(pair, {std::vector<float>(1, 1e-20f), {}}, {});
  EXPECT_LT(std::abs(test->largest.z), 0.1);
  EXPECT_TRUE(test->consistent);
}

// Every |z| is 1.4, either sign alike: only the sum of squares is too large, 1.96 times what is expected.
TEST(ZTest, TheChiSquareAloneCanTell) {
  std::vector<float> values;
  for (int i = 0; i < 256; ++i) values.push_back(i % 2 == 0 ? 1.4f : -1.4f);
  const ImagePair pair = pair_of(grey_image(16, 16, values), grey_image(16, 16, std::vector<float>(256)));
  const auto test = z_test(pair, {std::vector<float>(256, 1.0f), {}}, {});
  EXPECT_NEAR(test->block_chi_square.z, 1.96 * 256, 1e-2);
  EXPECT_EQ(test->largest.p, 1);
  EXPECT_EQ(test->block_mean.p, 1);
  EXPECT_EQ(test->image_mean.p, 1);
  EXPECT_FALSE(test->consistent);
}

// At a significance of 10 %, 200 pairs that differ by noise alone: the share that fails is binomial with at
// most that chance (Bonferroni bounds it from above, at most by a third here as the four parts hardly depend
// on each other), so between 4 and 40 of 200 but for about one chance in 1e4.
TEST(ZTest, FailsAsOftenAsItsSignificanceSays) {
  int failed = 0;
  double above = 0, square = 0;
  constexpr int kPairs = 200;
  for (std::uint32_t seed = 1; seed <= kPairs; ++seed) {
    const ZTest test = tested(noisy_pair(seed), 0.1);
    failed += !test.consistent;
    above += test.share_above_1_96 / kPairs;
    square += test.mean_square / kPairs;
  }
  EXPECT_GE(failed, 4);
  EXPECT_LE(failed, 40);
  const double values = double(kPairs) * 3 * kSide * kSide;
  EXPECT_NEAR(above, 0.05, 4 * std::sqrt(0.05 * 0.95 / values));
  EXPECT_NEAR(square, 1, 4 * std::sqrt(2 / values));
}

// The p-values of the image means are uniform: their largest distance from uniformity (Kolmogorov) stays
// below the limit of one chance in 1e3, 1.95 / sqrt(n).
TEST(ZTest, PValuesAreUniform) {
  std::vector<double> means, chi_squares;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    const ZTest test = tested(noisy_pair(1000 + seed));
    for (const double z : test.channel_mean_z) means.push_back(statistics::normal_cdf(z));
    chi_squares.insert(chi_squares.end(), test.channel_chi_square_p.begin(), test.channel_chi_square_p.end());
  }
  for (auto* p : {&means, &chi_squares}) {
    std::ranges::sort(*p);
    double distance = 0;
    for (std::size_t i = 0; i < p->size(); ++i)
      distance = std::max(distance, std::abs((*p)[i] - (double(i) + 0.5) / double(p->size())));
    EXPECT_LT(distance, 1.95 / std::sqrt(double(p->size())));
  }
}

// A shift of 0.02, a tenth of a value's deviation of sqrt(0.05) = 0.22: no single value shows it, the image's
// mean of 4096 values has a deviation of 0.0035 and shows 5.7 of them.
TEST(ZTest, SeesASmallShiftOfAllValues) {
  ImagePair pair = noisy_pair(5);
  ASSERT_TRUE(tested(pair).consistent);
  for (std::size_t i = 1; i < pair.image.size(); i += 3) pair.image[i] += 0.02f;
  const ZTest test = tested(pair);
  EXPECT_FALSE(test.consistent);
  EXPECT_EQ(test.image_mean.channel, 1u);
  EXPECT_LT(test.image_mean.p, 1e-5);
  EXPECT_GT(test.largest.p, 0.01);
}

// A block of 16 x 16 shifted by 0.1: 256 values whose mean has a deviation of 0.014.
TEST(ZTest, SeesABlockThatIsTooBright) {
  ImagePair pair = noisy_pair(6);
  for (int y = 32; y < 48; ++y) {
    for (int x = 16; x < 32; ++x) pair.image[std::size_t(y * kSide + x) * 3 + 2] += 0.1f;
  }
  const ZTest test = tested(pair);
  EXPECT_FALSE(test.consistent);
  EXPECT_EQ(test.block_mean.x, 16);
  EXPECT_EQ(test.block_mean.y, 32);
  EXPECT_EQ(test.block_mean.channel, 2u);
  EXPECT_LT(test.block_mean.p, 1e-5);
}

TEST(ZTest, SeesASingleWrongPixel) {
  ImagePair pair = noisy_pair(7);
  pair.window.x = 100;
  pair.image[std::size_t(9 * kSide + 5) * 3] = 2.0f - 8 * 0.2236f;
  const ZTest test = tested(pair);
  EXPECT_FALSE(test.consistent);
  EXPECT_EQ(test.largest.x, 105);
  EXPECT_EQ(test.largest.y, 9);
  EXPECT_LT(test.largest.z, -6);
}

// Noise in a block 1.5 times what the variance says: z^2 has mean 2.25, and the chi-square of 256 a deviation
// of 22.6.
TEST(ZTest, SeesNoiseThatIsLargerThanItSays) {
  ImagePair pair = noisy_pair(8);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      float& value = pair.image[std::size_t(y * kSide + x) * 3];
      value = pair.reference[std::size_t(y * kSide + x) * 3] +
              1.5f * (value - pair.reference[std::size_t(y * kSide + x) * 3]);
    }
  }
  const ZTest test = tested(pair);
  EXPECT_FALSE(test.consistent);
  EXPECT_EQ(test.block_chi_square.x, 0);
  EXPECT_EQ(test.block_chi_square.channel, 0u);
  EXPECT_LT(test.block_chi_square.p, 1e-6);
}

TEST(ZTest, ExtremeUnitsGiveTheSameAnswer) {
  const ImagePair pair = noisy_pair(9);
  const ZTest plain = tested(pair);
  for (const float scale : {0x1p-60f, 0x1p60f}) {  // 1e-18, 1e18; variances from 1e-38 to 1e35
    ImagePair scaled = pair;
    for (float& value : scaled.image) value *= scale;
    for (float& value : scaled.reference) value *= scale;
    const std::vector<float> a(pair.image.size(), kVarianceA * scale * scale);
    const std::vector<float> b(pair.image.size(), kVarianceB * scale * scale);
    const auto test = z_test(scaled, {a, {}}, {b, {}});
    ASSERT_TRUE(test);
    EXPECT_NEAR(test->mean_square, plain.mean_square, 1e-6);
    EXPECT_NEAR(test->largest.z, plain.largest.z, 1e-5);
    EXPECT_NEAR(test->block_mean.z, plain.block_mean.z, 1e-5);
  }
}

TEST(ZTest, DifferencesWithoutVarianceAreInconsistent) {
  ImagePair pair = noisy_pair(10);
  std::vector<float> a(pair.image.size(), kVarianceA), b(pair.image.size(), kVarianceB);
  ASSERT_TRUE(z_test(pair, {a, {}}, {b, {}})->consistent);
  a[30] = b[30] = 0;
  auto test = z_test(pair, {a, {}}, {b, {}});
  EXPECT_EQ(test->exact_different, 1u);
  EXPECT_FALSE(test->consistent);
  pair.image[30] = std::nextafter(pair.reference[30], 3.0f);  // rounding is no difference
  test = z_test(pair, {a, {}}, {b, {}});
  EXPECT_EQ(test->exact_equal, 1u);
  EXPECT_TRUE(test->consistent);
  for (const float bad :
       {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    a[30] = bad;
    test = z_test(pair, {a, {}}, {b, {}});
    EXPECT_EQ(test->invalid_variances, 1u);
    EXPECT_FALSE(test->consistent);
  }
}

TEST(ZTest, NothingNoisyIsJudgedByEquality) {
  const Image image = image_of(1, 1, {1, 2, 3});
  const std::vector<float> none(3, 0.0f);
  EXPECT_TRUE(z_test(pair_of(image, image), {none, {}}, {})->consistent);
  EXPECT_FALSE(z_test(pair_of(image, image_of(1, 1, {1, 2, 4})), {none, {}}, {})->consistent);
}

TEST(ZTest, NonFinitePixelsAreLeftOut) {
  Image image = image_of(2, 1, {1, 1, std::numeric_limits<float>::quiet_NaN(), 1, 1, 1});
  const ImagePair pair = pair_of(image, image_of(2, 1, std::vector<float>(6, 1.0f)));
  const std::vector<float> variance(6, 1.0f);
  EXPECT_EQ(z_test(pair, {variance, {}}, {})->values, 3u);
  EXPECT_TRUE(std::isnan(z_values(pair, {variance, {}}, {})[0]));
  EXPECT_EQ(z_values(pair, {variance, {}}, {})[3], 0);
}

TEST(ZTest, VarianceLayersAreFoundByName) {
  const Image image = image_of(1, 1, {1, 2, 3, 30, 10, 20, 7},
                               {"R", "G", "B", "variance.B", "variance.R", "variance.G", "depth.Z"});
  const ImagePair pair = pair_of(image, image);
  EXPECT_THAT(*variance_layer(image, pair), ::testing::ElementsAre(10, 20, 30));
  const auto missing = variance_layer(image_of(1, 1, {1, 2, 3}), pair);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("no layer 'variance'"));
  EXPECT_THAT(*variance_image(image_of(1, 1, {1, 2, 3}), pair), ::testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(*variance_image(grey_image(1, 1, {4}), pair), ::testing::ElementsAre(4, 4, 4));
  EXPECT_THAT(*variance_image(image, pair), ::testing::ElementsAre(10, 20, 30));
  const auto size = variance_image(grey_image(2, 1, {4, 4}), pair);
  ASSERT_FALSE(size);
  EXPECT_THAT(size.error().message, HasSubstr("2 x 1"));
  EXPECT_FALSE(variance_layer(image, pair, "albedo"));
}

TEST(ZTest, SaysWhatItCannotTake) {
  const ImagePair pair = pair_of(image_of(1, 1, {1, 2, 3}), image_of(1, 1, {1, 2, 3}));
  EXPECT_FALSE(z_test(pair, {}, {}));
  EXPECT_FALSE(z_test(pair, {std::vector<float>(2), {}}, {}));
  EXPECT_FALSE(z_test(pair, {std::vector<float>(3), {}}, {}, {.block = 0}));
}

}  // namespace
}  // namespace penumbra
