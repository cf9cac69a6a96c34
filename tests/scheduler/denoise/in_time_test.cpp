#include "scheduler/denoise/in_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/scheduler/denoise/shot_frames.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;

/// The mean square of all channels minus the truth.
double mean_square_error(const Image& image, const Truth& truth) {
  double sum = 0;
  for (int y = 0; y < kFrameHeight; ++y)
    for (int x = 0; x < kFrameWidth; ++x)
      for (std::size_t c = 0; c < 3; ++c) sum += std::pow(double(image.at(x, y, c)) - double(truth(x, y)), 2);
  return sum / (3 * kFrameWidth * kFrameHeight);
}

Image blended(const Image& frame, const FramesBeside& beside) {
  auto image = blended_in_time(frame, beside);
  EXPECT_TRUE(image) << image.error().message;
  return image.value_or(Image{});
}

TEST(InTime, VarianceFallsAsTheNumberOfFrames) {
  const Truth truth = [](int x, int) { return 1 + float(x) / kFrameWidth; };
  std::vector<Image> frames;
  for (std::uint32_t seed = 1; seed <= 5; ++seed) frames.push_back(frame_of(truth, 0.1f, seed));
  const std::vector<FramesBeside> beside = {
      {},
      {.before = {}, .after = {&frames[1]}},
      {.before = {}, .after = {&frames[1], &frames[2]}},
      {.before = {&frames[3]}, .after = {&frames[1], &frames[2]}},
      {.before = {&frames[3], &frames[4]}, .after = {&frames[1], &frames[2]}}};
  for (std::size_t k = 0; k < beside.size(); ++k) {
    const Image result = blended(frames[0], beside[k]);
    const double variance = mean_square_error(result, truth);
    // Distances are means of 147 terms (z^2 - 1) with z normal: weights are exp(-max(0, d)), d of deviation
    // .117. These unequal weights add at most 1 % to the variance of a mean. The variance of 9216 values is
    // known to 1.5 %: four deviations are 6 %.
    EXPECT_NEAR(variance * double(k + 1) / 0.01, 1.005, 0.06) << k + 1 << " frames";
    EXPECT_NEAR(double(result.at(20, 20, *result.channel("error.G"))) * double(k + 1) / 0.01, 1, 0.1);
  }
}

TEST(InTime, TranslationChangesNothing) {
  // Stripes and points that bilinear interpolation at other positions would blur.
  const auto pattern = [](int x, int y) { return (x * 7 + y * 13) % 5 == 0 ? 4.0f : 0.25f; };
  const auto at = [&](int frame) {
    return frame_of([&, frame](int x, int y) { return pattern(x - 3 * frame + 300, y); }, 0,
                    std::uint32_t(frame + 10), 3);
  };
  const Image frame = at(0), before[] = {at(-1), at(-2)}, after[] = {at(1), at(2)};
  const Image result = blended(frame, {.before = {&before[0], &before[1]}, .after = {&after[0], &after[1]}});
  for (int y = 0; y < kFrameHeight; ++y)
    for (int x = 0; x < kFrameWidth; ++x)
      EXPECT_NEAR(result.at(x, y, 0), frame.at(x, y, 0), 1e-6f * frame.at(x, y, 0)) << x << ", " << y;
  EXPECT_EQ(metadata_text(result, kFramesBefore), "9 8");
  EXPECT_EQ(metadata_text(result, kFramesAfter), "11 12");
}

TEST(InTime, OtherLightIsNotMixedIn) {
  // Ten deviations apart: the weight is exp(-(100 - 2) / 2).
  const Image frame = frame_of([](int, int) { return 1.0f; }, 0.1f, 1);
  const Image lit = frame_of([](int, int) { return 2.0f; }, 0.1f, 2);
  const Image result = blended(frame, {.before = {&lit}, .after = {}});
  for (std::size_t i = 0; i < frame.pixels(); ++i)
    EXPECT_NEAR(result.values[i * result.channels.size()], frame.values[i * frame.channels.size()], 1e-6f);
}

/// Sets a channel of all pixels.
Image with_channel(Image image, const char* channel, float value) {
  for (std::size_t i = 0; i < image.pixels(); ++i)
    image.values[i * image.channels.size() + *image.channel(channel)] = value;
  return image;
}

TEST(InTime, PointsThatAreHiddenAreNotMixedIn) {
  const Truth truth = [](int, int) { return 1.0f; };
  const Image frame = frame_of(truth, 0.1f, 1), next = frame_of(truth, 0.1f, 2);
  // Another way back, another depth, another side, and out of the image.
  const Image strangers[] = {with_channel(next, "motion.X", 2), with_channel(next, "depth.Z", 4),
                             with_channel(with_channel(next, "normal.Z", 0), "normal.X", 1)};
  for (const Image& stranger : strangers) {
    const Image result = blended(frame, {.before = {}, .after = {&stranger}});
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(result.at(30, 20, c), frame.at(30, 20, c));
  }
  const Image gone = with_channel(frame, "motion.Z", kFrameWidth);
  EXPECT_EQ(blended(gone, {.before = {}, .after = {&next}}).at(30, 20, 0), frame.at(30, 20, 0));
  EXPECT_NE(blended(frame, {.before = {}, .after = {&next}}).at(30, 20, 0), frame.at(30, 20, 0));
}

TEST(InTime, TextureIsOfTheFrameItself) {
  // Albedo that moves over a surface under even light, as a projected picture.
  const auto textured = [](std::uint32_t seed, int shift) {
    Image image = frame_of([](int, int) { return 1.0f; }, 0.05f, seed);
    for (int y = 0; y < kFrameHeight; ++y)
      for (int x = 0; x < kFrameWidth; ++x) {
        float* pixel = image.values.data() + std::size_t(y * kFrameWidth + x) * image.channels.size();
        const float albedo = (x + shift) % 4 < 2 ? 0.8f : 0.2f;
        for (std::size_t c = 0; c < 3; ++c) {
          pixel[c] *= albedo;
          pixel[c + 3] *= albedo * albedo;
          pixel[c + 10] = albedo;
        }
      }
    return image;
  };
  const Image frame = textured(1, 0), next = textured(2, 1);
  const Image result = blended(frame, {.before = {}, .after = {&next}});
  double before = 0, after = 0;
  for (int y = 0; y < kFrameHeight; ++y)
    for (int x = 0; x < kFrameWidth; ++x) {
      const double truth = x % 4 < 2 ? 0.8 : 0.2;
      before += std::pow(double(frame.at(x, y, 0)) - truth, 2);
      after += std::pow(double(result.at(x, y, 0)) - truth, 2);
    }
  EXPECT_NEAR(after / before, 0.5, 0.06);
}

TEST(InTime, TheOrderOfBlendingDoesNotMatter) {
  const Truth truth = [](int x, int y) { return 1 + 0.01f * float(x + y); };
  const Image a = frame_of(truth, 0.1f, 1), b = frame_of(truth, 0.1f, 2), c = frame_of(truth, 0.1f, 3);
  const Image first = blended(b, {.before = {&a}, .after = {&c}});
  const Image blended_a = blended(a, {.before = {}, .after = {&b, &c}});
  const Image blended_c = blended(c, {.before = {&b, &a}, .after = {}});
  EXPECT_EQ(blended(b, {.before = {&blended_a}, .after = {&blended_c}}).values, first.values);
  EXPECT_EQ(blended(first, {.before = {&blended_a}, .after = {&blended_c}}).values, first.values);
}

TEST(InTime, NonFiniteFramesAreLeftOut) {
  const Truth truth = [](int, int) { return 1.0f; };
  const Image frame = frame_of(truth, 0.1f, 1);
  for (const char* channel : {"R", "error.G", "motion.X", "depth.Z", "albedo.B", "normal.Y"})
    for (const float value : {NAN, INFINITY, -INFINITY}) {
      const Image bad = with_channel(frame_of(truth, 0.1f, 2), channel, value);
      const Image result = blended(frame, {.before = {}, .after = {&bad}});
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_TRUE(std::isfinite(result.at(30, 20, c))) << channel << value;
    }
}

TEST(InTime, WhatDoesNotFitIsSaid) {
  const Image frame = frame_of([](int, int) { return 1.0f; }, 0.1f, 1);
  Image small = frame;
  small.data.height = 40;
  const auto other_size = blended_in_time(frame, {.before = {&frame, &small}, .after = {}});
  ASSERT_FALSE(other_size);
  EXPECT_THAT(other_size.error().message,
              HasSubstr("2 before: it has 64 x 40 pixels, the frame beside it 64 x 48"));
  Image still = frame;
  still.channels[6] = "speed.X";
  EXPECT_THAT(lacks_for_time(still), HasSubstr("motion"));
  ASSERT_FALSE(blended_in_time(still, {}));
  Image without_halves = frame;
  without_halves.channels[4] = "errors.G";
  EXPECT_THAT(lacks_for_time(without_halves), HasSubstr("--denoise=layers"));
}

}  // namespace
}  // namespace penumbra
