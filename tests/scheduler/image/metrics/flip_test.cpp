#include "scheduler/image/metrics/flip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scheduler/image/metrics/flip_filters.h"
#include "tests/scheduler/image/metrics/small_images.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;

/// A smooth pattern in squares, and the same with noise: signals of a display, or 12 stops of radiance.
ImagePair patterned(int width, int height, bool hdr, double noise = 0.3) {
  std::vector<float> reference, image;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const std::uint64_t i = reference.size();
        const double square = (x / 8 + y / 8) % 2 == 1 ? 0.12 : -0.12;
        const float signal =
            float(std::clamp(0.5 + 0.35 * std::sin(0.31 * x + 0.17 * y + 2 * c) + square, 0.0, 1.0));
        if (hdr) {
          reference.push_back(float(std::exp2(12 * double(signal) - 6)));
          image.push_back(float(double(reference.back()) * (0.5 + hashed(i, 2))));
        } else {
          reference.push_back(signal);
          image.push_back(float(std::clamp(double(signal) + noise * (hashed(i, 1) - 0.5), 0.0, 1.0)));
        }
      }
    }
  }
  return pair_of(image_of(width, height, image), image_of(width, height, reference));
}

ImagePair flat(std::array<float, 3> image, std::array<float, 3> reference) {
  std::vector<float> a, b;
  for (int i = 0; i < 20 * 20; ++i) {
    a.insert(a.end(), image.begin(), image.end());
    b.insert(b.end(), reference.begin(), reference.end());
  }
  return pair_of(image_of(20, 20, a), image_of(20, 20, b));
}

/// The authors' evaluator (PyPI flip-evaluator 1.7) run on the same images.
struct Published {
  int width, height;
  bool hdr;
  double pixels_per_degree;
  double mean, largest, at_3_5, at_20_30, last;
  double start, stop;
  int exposures;
};
constexpr Published kPublished[] = {
    {48, 40, false, 67.020643, 0.274582, 0.535578, 0.190097, 0.259413, 0.436928, 0, 0, 1},
    {48, 40, false, 20, 0.430720, 0.755387, 0.260436, 0.462536, 0.491147, 0, 0, 1},
    {47, 41, false, 120, 0.123142, 0.348488, 0.122054, 0.184903, 0.235961, 0, 0, 1},
    {48, 40, true, 67.020643, 0.226023, 0.461220, 0.123091, 0.197776, 0.363491, -4.08240, -0.72199, 4},
    {47, 41, true, 67.020643, 0.159576, 0.406472, 0.140279, 0.085722, 0.364719, -4.08240, -0.71518, 4},
    {47, 41, true, 30, 0.291875, 0.671947, 0.264863, 0.233986, 0.503522, -4.08240, -0.71518, 4}};

// Both compute in float, with constants rounded to some digits.
constexpr double kRoundingOfBoth = 5e-5;
// Theirs are from weights of four decimals: the red one, 0.212639, is 1.8e-4 larger, log2(1.00018) of a stop.
constexpr double kLuminanceRounding = 2.7e-4;

TEST(Flip, AgreesWithTheAuthorsEvaluator) {
  for (const Published& expected : kPublished) {
    const ImagePair pair = patterned(expected.width, expected.height, expected.hdr);
    const auto flip = expected.hdr ? flip_of_radiance(pair, expected.pixels_per_degree)
                                   : flip_of_display_images(pair, expected.pixels_per_degree);
    ASSERT_TRUE(flip);
    const auto at = [&](int x, int y) { return flip->pixels[std::size_t(y * expected.width + x)]; };
    EXPECT_NEAR(flip->mean, expected.mean, kRoundingOfBoth);
    EXPECT_NEAR(flip->largest, expected.largest, kRoundingOfBoth);
    EXPECT_NEAR(at(3, 5), expected.at_3_5, kRoundingOfBoth);
    EXPECT_NEAR(at(20, 30), expected.at_20_30, kRoundingOfBoth);
    EXPECT_NEAR(at(expected.width - 1, expected.height - 1), expected.last, kRoundingOfBoth);
    EXPECT_EQ(at(flip->x, flip->y), float(flip->largest));
    EXPECT_EQ(flip->hdr, expected.hdr);
    EXPECT_EQ(flip->exposures.count, expected.exposures);
    EXPECT_NEAR(flip->exposures.start, expected.start, kLuminanceRounding);
    EXPECT_NEAR(flip->exposures.stop, expected.stop, kLuminanceRounding);
  }
}

// Without structure only the colour part is left. Black and white differ by 100 in lightness and nothing
// else; green and blue are the largest difference by definition.
TEST(Flip, FlatColours) {
  EXPECT_NEAR(flip_of_display_images(flat({0, 1, 0}, {0, 0, 1}))->mean, 1, 1e-6);
  EXPECT_NEAR(flip_of_display_images(flat({1, 1, 1}, {0, 0, 0}))->mean, 0.967386, kRoundingOfBoth);
  EXPECT_NEAR(flip_of_display_images(flat({1, 0, 0}, {0, 1, 0}))->mean, 0.986664, kRoundingOfBoth);
  EXPECT_NEAR(flip_of_display_images(flat({0.6f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}))->mean, 0.249647,
              kRoundingOfBoth);
}

// From the formulas alone: dark greys stay below the knee, where the error is 0.95 (difference / knee)^0.7.
TEST(Flip, GreysFollowTheLightnessDifference) {
  const auto error = [](float a, float b) {
    return flip_of_display_images(flat({a, a, a}, {b, b, b}))->mean;
  };
  const auto lightness = [](double signal) {  // above the linear part
    return 116 * std::cbrt(std::pow((signal + 0.055) / 1.055, 2.4)) - 16;
  };
  const double ratio = error(0.5f, 0.45f) / error(0.5f, 0.4f);
  const double expected =
      std::pow((lightness(0.5) - lightness(0.45)) / (lightness(0.5) - lightness(0.4)), 0.7);
  // The filters add 2 x 21 terms in float, each rounded to 2^-24 of a sum of at most 25 (Yy), which is 116
  // times the luminance; lightness changes by less than 1 for it, differs by 5 at least and enters to the
  // power of 0.7 above and below.
  constexpr double kFloatSums = 42 * 0x1p-24 * 25 / 5 * 0.7 * 2;
  EXPECT_NEAR(ratio, expected, kFloatSums * expected);
}

TEST(Flip, IsSymmetricInZeroToOneAndZeroForEqualImages) {
  for (const bool hdr : {false, true}) {
    ImagePair pair = patterned(64, 64, hdr);
    const auto run = [&] { return hdr ? flip_of_radiance(pair) : flip_of_display_images(pair); };
    const auto forth = run();
    for (const float value : forth->pixels) {
      ASSERT_GE(value, 0.0f);
      ASSERT_LE(value, 1.0f);
    }
    std::swap(pair.image, pair.reference);
    const auto back = run();
    // The exposures of HDR-FLIP are the reference's.
    if (!hdr) EXPECT_EQ(forth->pixels, back->pixels);
    pair.image = pair.reference;
    EXPECT_EQ(run()->mean, 0);
    EXPECT_EQ(run()->largest, 0);
  }
}

TEST(Flip, GrowsWithNoiseAndFallsWithDistance) {
  double last = 0;
  for (const double noise : {0.02, 0.05, 0.1, 0.2, 0.4, 0.8}) {
    const double error = flip_of_display_images(patterned(64, 64, false, noise))->mean;
    EXPECT_GT(error, last);
    last = error;
  }
  last = 1;
  for (const double pixels_per_degree : {10, 20, 40, 80, 160}) {
    const double error = flip_of_display_images(patterned(64, 64, false), pixels_per_degree)->mean;
    EXPECT_LT(error, last);
    last = error;
  }
}

TEST(Flip, AMutatedPixelIsSeenWhereItIs) {
  ImagePair pair = patterned(64, 48, false);
  pair.image = pair.reference;
  pair.image[(20 * 64 + 30) * 3] += 0.3f;
  const auto flip = flip_of_display_images(pair);
  EXPECT_GT(flip->largest, 0.05);
  EXPECT_NEAR(flip->x, 30, 1);
  EXPECT_NEAR(flip->y, 20, 1);
  EXPECT_EQ(flip->pixels[0], 0);  // out of reach of the filters, whose radius is 10
}

TEST(Flip, TheToneMapTakesTheExposuresTo85Percent) {
  const ImagePair pair = patterned(47, 41, true);
  const FlipExposures exposures = flip_exposures(pair);
  std::vector<double> luminances;
  for (std::size_t i = 0; i < pair.reference.size(); i += 3)
    luminances.push_back(0.212639 * pair.reference[i] + 0.715169 * pair.reference[i + 1] +
                         0.072192 * pair.reference[i + 2]);
  std::ranges::sort(luminances);
  EXPECT_NEAR(aces_tone_map(std::exp2(exposures.start) * luminances.back()), 0.85, 1e-5);
  EXPECT_NEAR(aces_tone_map(std::exp2(exposures.stop) * luminances[luminances.size() / 2]), 0.85, 1e-5);
  EXPECT_EQ(exposures.count, std::max(2, int(std::ceil(exposures.stop - exposures.start))));
  EXPECT_EQ(aces_tone_map(0), 0);
  EXPECT_EQ(aces_tone_map(1e100), 1);
}

TEST(Flip, TheMedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
  const ImagePair pair = pair_of(grey_image(4, 1, {0, 0, 0, 0}), grey_image(4, 1, {8, 1, 4, 0}));
  const FlipExposures exposures = flip_exposures(pair);
  EXPECT_NEAR(aces_tone_map(std::exp2(exposures.start) * 8), 0.85, 1e-12);
  EXPECT_NEAR(aces_tone_map(std::exp2(exposures.stop) * 2.5), 0.85, 1e-12);
}

TEST(Flip, HdrIsIndependentOfTheUnit) {
  const ImagePair pair = patterned(40, 40, true);
  const auto plain = flip_of_radiance(pair);
  for (const float scale : {0x1p-100f, 0x1p-66f, 0x1p66f, 0x1p100f}) {  // 8e-31 to 1e30
    ImagePair scaled = pair;
    for (float& value : scaled.image) value *= scale;
    for (float& value : scaled.reference) value *= scale;
    const auto flip = flip_of_radiance(scaled);
    EXPECT_NEAR(flip->mean, plain->mean, 1e-6) << scale;
    EXPECT_EQ(flip->exposures.count, plain->exposures.count);
  }
}

TEST(Flip, BlackReferences) {
  ImagePair pair = patterned(20, 20, true);
  std::ranges::fill(pair.reference, 0.0f);
  const auto black = flip_of_radiance(pair);
  EXPECT_EQ(black->exposures, FlipExposures{});
  EXPECT_GT(black->mean, 0.5);
  // A spot on black: the median is that of the spot.
  pair.reference[0] = pair.reference[1] = pair.reference[2] = 4;
  EXPECT_EQ(flip_exposures(pair).start, flip_exposures(pair).stop);
  EXPECT_EQ(flip_exposures(pair).count, 2);
  EXPECT_TRUE(std::isfinite(flip_of_radiance(pair)->mean));
}

TEST(Flip, NonFinitePixelsAreLeftOut) {
  ImagePair pair = patterned(32, 32, true);
  Image image = image_of(32, 32, pair.image);
  image.values[3 * 100] = std::numeric_limits<float>::quiet_NaN();
  image.values[3 * 200] = std::numeric_limits<float>::infinity();
  const auto flip = flip_of_radiance(pair_of(image, image_of(32, 32, pair.reference)));
  ASSERT_TRUE(flip);
  double sum = 0;
  for (std::size_t i = 0; i < flip->pixels.size(); ++i) {
    EXPECT_EQ(std::isnan(flip->pixels[i]), i == 100 || i == 200) << i;
    if (!std::isnan(flip->pixels[i])) sum += flip->pixels[i];
  }
  EXPECT_NEAR(flip->mean, sum / (32 * 32 - 2), 1e-12);
}

TEST(Flip, SaysWhatItCannotTake) {
  const Image two = image_of(1, 1, {1, 2}, {"uv.X", "uv.Y"});
  const auto channels = flip_of_display_images(*pair_images(two, two, nullptr, "uv"));
  ASSERT_FALSE(channels);
  EXPECT_THAT(channels.error().message, HasSubstr("2 channels"));
  EXPECT_FALSE(flip_of_radiance(patterned(8, 8, true), 0));
  EXPECT_FALSE(flip_of_radiance(patterned(8, 8, true), NAN));
}

TEST(FlipFilters, ConvolutionByDirectSums) {
  Plane source(13, 7);
  for (std::size_t i = 0; i < source.values.size(); ++i) source.values[i] = float(hashed(i, 3));
  const Kernel across{{0.25, -1, 2, 0.5, 0.125}}, down{{1, 3, -2}};
  const Plane result = convolve(source, across, down);
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 13; ++x) {
      double sum = 0;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -2; i <= 2; ++i) {
          const int from = std::clamp(y + j, 0, 6) * 13 + std::clamp(x + i, 0, 12);
          sum += down.weights[std::size_t(j + 1)] * across.weights[std::size_t(i + 2)] *
                 source.values[std::size_t(from)];
        }
      }
      EXPECT_NEAR(result.values[std::size_t(y * 13 + x)], sum, 1e-5);
    }
  }
}

TEST(FlipFilters, ConstantsPassAndHaveNoFeatures) {
  Plane flat_plane(30, 200);
  std::ranges::fill(flat_plane.values, 0.7f);
  for (const Sensitivity& s : {kLightSensitivity, kRedGreenSensitivity, kBlueYellowSensitivity}) {
    for (const float value : filter_by_sensitivity(flat_plane, s, 67).values) ASSERT_NEAR(value, 0.7f, 1e-6);
  }
  for (const float value : edge_response(flat_plane, 67).values) ASSERT_EQ(value, 0);
  for (const float value : point_response(flat_plane, 67).values) ASSERT_EQ(value, 0);
}

TEST(FlipFilters, AStepHasAnEdgeOfItsHeight) {
  Plane step(60, 60);
  for (int y = 0; y < 60; ++y) {
    for (int x = 30; x < 60; ++x) step.values[std::size_t(y * 60 + x)] = 0.5f;
  }
  // All positive weights on one side of the step, all negative ones on the other: but for the middle one,
  // which is 0.
  float largest = 0;
  for (const float value : edge_response(step, 67).values) largest = std::max(largest, value);
  EXPECT_NEAR(largest, 0.5, 1e-5);
}

}  // namespace
}  // namespace penumbra
