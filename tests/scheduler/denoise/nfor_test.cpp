#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/denoise/denoise_task.h"
#include "scheduler/denoise/guide.h"
#include "tests/scheduler/denoise/noisy_images.h"

namespace penumbra {
namespace {

/// A texture under light that varies slowly.
float albedo(int x, int y, int c) { return (x / 3 + y / 5) % 2 == 0 ? 0.8f : 0.2f + 0.2f * float(c); }
float lit(int x, int y, int c) { return albedo(x, y, c) * (0.5f + 0.5f * float(x) / 96); }

DenoiseInput textured(float sigma, std::uint32_t seed) {
  DenoiseInput input = noisy_image(96, 80, lit, sigma, seed);
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 96; ++x) input.features.plane(c)[std::size_t(y * 96 + x)] = albedo(x, y, c);
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 96; ++x) {
      input.features.plane(5)[std::size_t(y * 96 + x)] = 1;
      input.features.plane(6)[std::size_t(y * 96 + x)] = 0.5f + float(x) / 192;
    }
  return input;
}

TEST(Nfor, KeepsATextureThatAFeatureHas) {
  const DenoiseInput input = textured(0.1f, 1);
  const auto with = nfor(*test_device(), input);
  ASSERT_TRUE(with) << with.error().message;
  const auto nlm = nl_means(*test_device(), input, {});
  ASSERT_TRUE(nlm);
  const double error = rms_error(with->color, lit);
  EXPECT_LT(error, rms_error(nlm->color, lit) / 2);
  // A model has 8 parameters and 225 neighbours: sigma sqrt(8 / 225) without the mean over models.
  EXPECT_LT(error, 0.1 * std::sqrt(8.0 / 225));
}

TEST(Nfor, FitsLinearFunctionsOfFeatures) {
  // Without noise in the distances' sense: all pixels of a window have weight, and the truth is linear in the
  // features, so that only the damping of slopes is left.
  DenoiseInput input = textured(0, 1);
  const auto linear = [&](int x, int y, int c) {
    const auto i = std::size_t(y * 96 + x);
    return 0.3f + 0.5f * input.features.plane(c)[i] + 0.2f * input.features.plane(6)[i];
  };
  DenoiseInput image = noisy_image(96, 80, linear, 0, 1);
  image.features = input.features;
  image.variance = Planes(96, 80, 3, 100);  // whatever differs may be noise
  const auto denoised = nfor(*test_device(), image);
  ASSERT_TRUE(denoised);
  // Slopes are damped by 1e-3 of their variance, and depth, of which a window shows 0.08, by 1e-3 / 0.02.
  EXPECT_LT(rms_error(denoised->color, linear), 1e-3);
}

TEST(Nfor, ReturnsAnImageWithoutNoise) {
  const auto pattern = [](int x, int y, int c) {
    return float((x * 7919 + y * 104729 + c * 31) % 1009) / 1009;
  };
  const DenoiseInput input = noisy_image(50, 40, pattern, 0, 3);
  const auto denoised = nfor(*test_device(), input);
  ASSERT_TRUE(denoised);
  for (std::size_t i = 0; i < input.color.values.size(); ++i)
    ASSERT_NEAR(denoised->color.values[i], input.color.values[i], 1e-6);
}

TEST(Nfor, RemovesNoiseFromFeatures) {
  DenoiseInput input = textured(0.1f, 2);
  const DenoiseInput noise = noisy_image(
      96, 80, [](int, int, int) { return 0.0f; }, 0.05f, 9);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < input.features.pixels(); ++i) {
      input.features.plane(c)[i] += noise.color.plane(c)[i];
      input.feature_variance.plane(c)[i] = 0.05f * 0.05f;
    }
  const auto denoised = nfor(*test_device(), input);
  ASSERT_TRUE(denoised);
  EXPECT_LT(rms_error(denoised->color, lit), 0.1 / 3);
}

TEST(Nfor, WithoutHalvesAndFeaturesStillRemovesNoise) {
  const auto constant = [](int, int, int) { return 0.5f; };
  DenoiseInput input = noisy_image(80, 70, constant, 0.1f, 3);
  input.half_a = input.half_b = {};
  const auto denoised = nfor(*test_device(), input);
  ASSERT_TRUE(denoised);
  EXPECT_LT(rms_error(denoised->color, constant), 0.1 / 4);
  EXPECT_EQ(denoised->residual_variance.count, 0);
}

TEST(Nfor, IsTheSameInAWindowWithItsSurroundings) {
  const DenoiseInput input = noisy_image(200, 190, lit, 0.1f, 6);
  const auto whole = nfor(*test_device(), input);
  // Outliers 2, filter of features 5 + 3, models and their predictions 7 + 3 and 7, errors and choice
  // 2 (9 + 1), rounded up.
  const int halo = 48;
  const auto part = nfor(*test_device(), crop(input, 60 - halo, 55 - halo, 70 + 2 * halo, 61 + 2 * halo));
  ASSERT_TRUE(whole && part);
  EXPECT_EQ(crop(whole->color, 60, 55, 70, 61).values, crop(part->color, halo, halo, 70, 61).values);
}

}  // namespace
}  // namespace penumbra
