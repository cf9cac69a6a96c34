#include "scheduler/denoise/in_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "scheduler/denoise/layers.h"
#include "tests/scheduler/denoise/shot_frames.h"

namespace penumbra {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kVariance = 3, kAlbedo = 10, kDepth = 16, kHalfA = 17, kHalfB = 20;  // of frame_of

/// The mean square of all channels minus the truth.
double mean_square_error(const Image& image, const Truth& truth) {
  double sum = 0;
  for (int y = 0; y < kFrameHeight; ++y)
    for (int x = 0; x < kFrameWidth; ++x)
      for (std::size_t c = 0; c < 3; ++c) sum += std::pow(double(image.at(x, y, c)) - double(truth(x, y)), 2);
  return sum / (3 * kFrameWidth * kFrameHeight);
}

Image blended(const Image& frame, const std::vector<Image>& before, const std::vector<Image>& after) {
  for (const Image& image : before) EXPECT_EQ(lacks_for_time(image), "");
  for (const Image& image : after) EXPECT_EQ(lacks_for_time(image), "");
  std::vector<FrameInTime> frames;
  frames.reserve(before.size() + after.size());
  FramesBeside beside;
  for (const Image& image : before) beside.before.push_back(&frames.emplace_back(frame_in_time(image)));
  for (const Image& image : after) beside.after.push_back(&frames.emplace_back(frame_in_time(image)));
  const Image result = blended_in_time(frame_in_time(frame), beside, 1);
  EXPECT_EQ(blended_in_time(frame_in_time(frame), beside, 3).values, result.values);
  return result;
}

TEST(InTime, VarianceFallsAsTheNumberOfFrames) {
  const Truth truth = [](int x, int) { return 1 + float(x) / kFrameWidth; };
  std::vector<Image> frames;
  for (std::uint32_t seed = 1; seed <= 5; ++seed) frames.push_back(frame_of(truth, 0.1f, seed));
  using Images = std::vector<Image>;
  const std::pair<Images, Images> beside[] = {{{}, {}},
                                              {{}, {frames[1]}},
                                              {{}, {frames[1], frames[2]}},
                                              {{frames[3]}, {frames[1], frames[2]}},
                                              {{frames[3], frames[4]}, {frames[1], frames[2]}}};
  for (std::size_t k = 0; k < std::size(beside); ++k) {
    const Image result = blended(frames[0], beside[k].first, beside[k].second);
    const double variance = mean_square_error(result, truth);
    // Distances are means of 147 terms (z^2 - 1) with z normal: weights are exp(-max(0, d)), d of deviation
    // .117. These unequal weights add at most 1 % to the variance of a mean. The variance of 9216 values is
    // known to 1.5 %: four deviations are 6 %.
    EXPECT_NEAR(variance * double(k + 1) / 0.01, 1.005, 0.06) << k + 1 << " frames";
    EXPECT_NEAR(double(result.at(20, 20, *result.channel("variance.G"))) * double(k + 1) / 0.01, 1, 0.1);
    // The halves stay independent: their difference has four times the variance of their mean.
    double difference = 0;
    for (std::size_t i = 0; i < result.pixels(); ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        const float* pixel = result.values.data() + i * result.channels.size();
        difference += std::pow(double(pixel[kHalfA + c]) - double(pixel[kHalfB + c]), 2);
      }
    EXPECT_NEAR(difference / double(3 * result.pixels()) * double(k + 1) / 0.04, 1.005, 0.06);
  }
}

TEST(InTime, TranslationChangesNothing) {
  // Stripes and points that bilinear interpolation at other positions would blur.
  const auto pattern = [](int x, int y) { return (x * 7 + y * 13) % 5 == 0 ? 4.0f : 0.25f; };
  const auto at = [&](int frame) {
    return frame_of([&, frame](int x, int y) { return pattern(x - 3 * frame + 300, y); }, 0,
                    std::uint32_t(frame + 10), 3);
  };
  const Image frame = at(0), result = blended(frame, {at(-1), at(-2)}, {at(1), at(2)});
  for (int y = 0; y < kFrameHeight; ++y)
    for (int x = 0; x < kFrameWidth; ++x)
      EXPECT_NEAR(result.at(x, y, 0), frame.at(x, y, 0), 1e-6f * frame.at(x, y, 0)) << x << ", " << y;
}

TEST(InTime, OtherLightIsNotMixedIn) {
  // Halves of variance .02: distances are about (1 - .04) / .04, weights exp(-24).
  const Image frame = frame_of([](int, int) { return 1.0f; }, 0.1f, 1);
  const Image lit = frame_of([](int, int) { return 2.0f; }, 0.1f, 2);
  const Image result = blended(frame, {lit}, {});
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
    const Image result = blended(frame, {}, {stranger});
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(result.at(30, 20, c), frame.at(30, 20, c));
  }
  const Image gone = with_channel(frame, "motion.Z", kFrameWidth);
  EXPECT_EQ(blended(gone, {}, {next}).at(30, 20, 0), frame.at(30, 20, 0));
  EXPECT_NE(blended(frame, {}, {next}).at(30, 20, 0), frame.at(30, 20, 0));
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
          for (const std::size_t channel : {c, kHalfA + c, kHalfB + c}) pixel[channel] *= albedo;
          pixel[kVariance + c] *= albedo * albedo;
          pixel[kAlbedo + c] = albedo;
        }
      }
    return image;
  };
  const Image frame = textured(1, 0), next = textured(2, 1);
  const Image result = blended(frame, {}, {next});
  double before = 0, after = 0;
  for (int y = 0; y < kFrameHeight; ++y)
    for (int x = 0; x < kFrameWidth; ++x) {
      const double truth = x % 4 < 2 ? 0.8 : 0.2;
      before += std::pow(double(frame.at(x, y, 0)) - truth, 2);
      after += std::pow(double(result.at(x, y, 0)) - truth, 2);
    }
  EXPECT_NEAR(after / before, 0.5, 0.06);
}

TEST(InTime, NoiseOfAlbedoFalls) {
  const auto noisy = [](std::uint32_t seed) {
    const Image albedo = frame_of([](int, int) { return 0.5f; }, 0.05f, seed + 10);
    Image image = frame_of([](int, int) { return 1.0f; }, 0.1f, seed);
    const std::string names[] = {"albedo_variance.R", "albedo_variance.G", "albedo_variance.B"};
    image = with_channels(image, names, Planes(kFrameWidth, kFrameHeight, 3, 0.0025f));
    for (std::size_t i = 0; i < image.pixels(); ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        float* pixel = image.values.data() + i * image.channels.size();
        pixel[kAlbedo + c] = albedo.values[i * albedo.channels.size() + c];
        // Light is 1, whatever the albedo.
        for (const std::size_t channel : {c, kHalfA + c, kHalfB + c}) pixel[channel] *= pixel[kAlbedo + c];
      }
    return image;
  };
  const auto square = [](const Image& image) {
    double sum = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i)
      sum += std::pow(double(image.values[i * image.channels.size() + kAlbedo]) - 0.5, 2);
    return sum;
  };
  const Image frame = noisy(1);
  // Patches of 27 terms: weights exp(-max(0, d)), d of deviation .27, have the mean .9 and add less than 2 %.
  // 3072 values: known to 2.6 %; four deviations are 10 %.
  EXPECT_NEAR(square(blended(frame, {noisy(2)}, {})) / square(frame), 0.505, 0.05);
}

TEST(InTime, EdgesBetweenPixelsAreNotMixed) {
  // Halfway between pixels only those of the same surface count.
  const auto frame = [](std::uint32_t seed) {
    Image image = frame_of([](int x, int) { return x < 30 ? 1.0f : 3.0f; }, 0, seed, 0.5f);
    for (int y = 0; y < kFrameHeight; ++y)
      for (int x = 30; x < kFrameWidth; ++x)
        image.values[std::size_t(y * kFrameWidth + x) * image.channels.size() + kDepth] = 50;
    return image;
  };
  const Image own = frame(1), result = blended(own, {frame(2)}, {frame(3)});
  for (int x = 0; x < kFrameWidth; ++x) EXPECT_FLOAT_EQ(result.at(x, 20, 0), own.at(x, 20, 0)) << x;
}

TEST(InTime, NonFiniteFramesAreLeftOut) {
  const Truth truth = [](int, int) { return 1.0f; };
  const Image frame = frame_of(truth, 0.1f, 1);
  for (const char* channel : {"half_a.R", "variance.G", "motion.X", "depth.Z", "albedo.B", "normal.Y"})
    for (const float value : {NAN, INFINITY, -INFINITY}) {
      const Image bad = with_channel(frame_of(truth, 0.1f, 2), channel, value);
      const Image result = blended(frame, {}, {bad});
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_TRUE(std::isfinite(result.at(30, 20, c))) << channel << value;
    }
}

TEST(InTime, WhatIsLackingIsSaid) {
  const auto without = [](std::size_t channel) {
    Image image = frame_of([](int, int) { return 1.0f; }, 0.1f, 1);
    image.channels[channel] = "other.X";
    return lacks_for_time(image);
  };
  EXPECT_THAT(without(0), HasSubstr("R, G, B"));
  EXPECT_THAT(without(6), HasSubstr("--layers motion"));
  for (const std::size_t channel : {kVariance, kHalfA, kHalfB})
    EXPECT_THAT(without(channel), HasSubstr("--denoise=layers"));
}

}  // namespace
}  // namespace penumbra
