#include "scheduler/denoise/outliers.h"

#include <gtest/gtest.h>

#include "tests/scheduler/denoise/noisy_images.h"

namespace penumbra {
namespace {

constexpr int kWidth = 96, kHeight = 80;
float grey(int, int, int) { return 0.5f; }

/// One sample of 8, of the radiance `value`, in one pixel of the first half.
void add_firefly(DenoiseInput& input, float value, std::size_t pixel) {
  for (int c = 0; c < 3; ++c) {
    input.half_a.plane(c)[pixel] += value / 4;
    input.color.plane(c)[pixel] += value / 8;
    input.variance.plane(c)[pixel] += value * value / 64;
  }
}

TEST(Outliers, AFireflyLeavesNoTraceInDenoisedImages) {
  const DenoiseInput clean = noisy_image(kWidth, kHeight, grey, 0.1f, 1);
  DenoiseInput noisy = clean;
  for (std::size_t pixel = 1000; pixel < clean.color.pixels(); pixel += 997) add_firefly(noisy, 1000, pixel);
  for (const bool regress : {false, true}) {
    const auto run = [&](const DenoiseInput& input) {
      const auto denoised = regress ? nfor(*test_device(), input) : nl_means(*test_device(), input, {});
      return rms_error(denoised.value().color, grey);
    };
    // A firefly becomes at most the largest of some 25 values and a standard deviation, three of those above
    // the mean; as a mean of 100 pixels that is less than the noise that is left.
    EXPECT_LT(run(noisy), 2 * run(clean)) << regress;
  }
}

TEST(Outliers, WhatBothHalvesShowStays) {
  const auto stars = [](int x, int y, int) { return x % 7 == 3 && y % 9 == 4 ? 1000.0f : 0.5f; };
  const DenoiseInput noisy = noisy_image(kWidth, kHeight, stars, 0, 1), limited = without_outliers(noisy);
  EXPECT_EQ(limited.half_a.values, noisy.half_a.values);
  EXPECT_EQ(limited.half_b.values, noisy.half_b.values);
  EXPECT_EQ(limited.color.values, noisy.color.values);
}

TEST(Outliers, NormalNoiseKeepsItsMean) {
  constexpr float kSigma = 0.1f;
  const DenoiseInput noisy = noisy_image(kWidth, kHeight, grey, kSigma, 2), limited = without_outliers(noisy);
  double loss = 0;
  for (std::size_t i = 0; i < noisy.color.values.size(); ++i)
    loss += double(noisy.half_a.values[i] - limited.half_a.values[i]) / double(noisy.color.values.size());
  // Without the margin, the mean of what exceeds the largest of 25 others is E max of 26 - E max of 25 =
  // 0.017 standard deviations (1.982 - 1.965), and more at the border.
  EXPECT_GT(loss, 0);
  EXPECT_LT(loss, 0.017 * double(kSigma) * 1.4143);
}

TEST(Outliers, WithoutHalvesNothingIsKnown) {
  DenoiseInput noisy = noisy_image(kWidth, kHeight, grey, 0.1f, 3);
  noisy.half_a = noisy.half_b = {};
  EXPECT_EQ(without_outliers(noisy).color.values, noisy.color.values);
}

}  // namespace
}  // namespace penumbra
