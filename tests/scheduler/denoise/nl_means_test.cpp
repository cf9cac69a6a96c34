#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scheduler/denoise/guide.h"
#include "scheduler/denoise/outliers.h"
#include "tests/scheduler/denoise/noisy_images.h"

namespace penumbra {
namespace {

float constant(int, int, int c) { return 0.5f + 0.25f * float(c); }
float edge(int x, int, int) { return x < 24 ? 1.0f : 0.25f; }

/// Non-local means in double precision, straight from the formula: d² = mean over channels and patch of
/// ((u_p - u_q)² - (Var_p + min(Var_p, Var_q))) / (epsilon + k² (Var_p + Var_q)), w = exp(-max(0, d²)).
/// Pixels outside of the image are those at its edge in patches, and are no neighbours.
double reference_pixel(const Planes& guide, const Planes& variance, const Planes& source, int x, int y, int c,
                       const NlMeansOptions& options) {
  const int width = guide.width, height = guide.height, f = options.patch_radius, r = options.search_radius;
  const double k2 = double(options.strength) * double(options.strength);
  const auto at = [&](const Planes& image, int channel, int px, int py) {
    px = std::clamp(px, 0, width - 1), py = std::clamp(py, 0, height - 1);
    return double(image.plane(channel)[std::size_t(py * width + px)]);
  };
  double sum = 0, weights = 0;
  for (int qy = std::max(0, y - r); qy <= std::min(height - 1, y + r); ++qy)
    for (int qx = std::max(0, x - r); qx <= std::min(width - 1, x + r); ++qx) {
      double distance = 0;
      for (int channel = 0; channel < 3; ++channel)
        for (int dy = -f; dy <= f; ++dy)
          for (int dx = -f; dx <= f; ++dx) {
            // A patch that hangs over the edge is compared where both of its pixels exist.
            const auto inside = [&](int px, int py) {
              return px >= 0 && py >= 0 && px < width && py < height;
            };
            if (!inside(x + dx, y + dy) || !inside(qx + dx, qy + dy)) continue;
            const double difference =
                at(guide, channel, x + dx, y + dy) - at(guide, channel, qx + dx, qy + dy);
            const double p = at(variance, channel, x + dx, y + dy),
                         q = at(variance, channel, qx + dx, qy + dy);
            distance += (difference * difference - (p + std::min(p, q))) / (1e-8 + k2 * (p + q));
          }
      double weight = std::exp(-std::max(0.0, distance / (3 * (2 * f + 1) * (2 * f + 1))));
      if (weight < 1e-5) weight = 0;
      sum += weight * at(source, c, qx, qy);
      weights += weight;
    }
  return sum / weights;
}

TEST(NlMeans, IsItsFormulaInDoublePrecision) {
  const DenoiseInput input = noisy_image(41, 37, edge, 0.1f, 1);
  Planes variance = input.variance;
  for (std::size_t i = 0; i < variance.values.size(); ++i) variance.values[i] *= 0.5f + float(i % 7) / 7;
  for (const NlMeansOptions& options :
       {NlMeansOptions{}, NlMeansOptions{.search_radius = 3, .patch_radius = 0, .strength = 1},
        NlMeansOptions{.search_radius = 12, .patch_radius = 5, .strength = 0.7f},
        NlMeansOptions{.search_radius = 0, .patch_radius = 1, .strength = 1}}) {
    const auto filtered =
        filter(*test_device(), make_guide(input.half_a, variance, 1, input.valid), input.half_b, options);
    ASSERT_TRUE(filtered) << filtered.error().message;
    for (int y = 0; y < 37; y += 9)
      for (int x = 0; x < 41; x += 8)
        for (int c = 0; c < 3; ++c)
          // Rounding of some 100 terms of a distance, and of the sums; a weight at the limit of 1e-5 may be
          // kept in one and dropped in the other.
          ASSERT_NEAR(filtered->plane(c)[std::size_t(y * 41 + x)],
                      reference_pixel(input.half_a, variance, input.half_b, x, y, c, options), 3e-5)
              << x << " " << y << " r=" << options.search_radius;
  }
}

TEST(NlMeans, RemovesNoiseFromAConstant) {
  constexpr float kSigma = 0.1f;
  constexpr int kSide = 192;
  const DenoiseInput input = noisy_image(kSide, kSide, constant, kSigma, 2);
  const auto denoised = nl_means(*test_device(), input, {});
  ASSERT_TRUE(denoised);
  const double error = rms_error(denoised->color, constant);
  // With equal weights it would be sigma / 21 inside; weights by similarity keep at least half of them.
  EXPECT_LT(error, kSigma / 10);
  for (int c = 0; c < 3; ++c) {
    double mean = 0;
    for (const float value : denoised->color.plane(c)) mean += double(value) / (kSide * kSide);
    // The mean of the noisy image has a standard deviation of sigma / side; pixels at the edge weigh more.
    EXPECT_NEAR(mean, double(constant(0, 0, c)), 4 * kSigma / kSide * 1.5);
  }
  // What is left varies over areas of about 21 x 21 pixels, of which there are some 80, in three channels:
  // the estimate's standard deviation is about sqrt(2 / 240) = 9 %.
  double residual = 0;
  for (const float value : denoised->residual_variance.values)
    residual += double(value) / double(denoised->residual_variance.values.size());
  EXPECT_NEAR(std::sqrt(residual) / error, 1, 0.25);
}

TEST(NlMeans, ReturnsAnImageWithoutNoise) {
  const auto pattern = [](int x, int y, int c) {
    return float((x * 7919 + y * 104729 + c * 31) % 1009) / 1009;
  };
  const DenoiseInput input = noisy_image(50, 40, pattern, 0, 3);
  const auto denoised = nl_means(*test_device(), input, {});
  ASSERT_TRUE(denoised);
  EXPECT_EQ(denoised->color.values, input.color.values);
}

TEST(NlMeans, KeepsTheEdgesOfLightsWithoutNoise) {
  const auto light = [](int x, int y, int) {
    const bool inside = x >= 20 && x < 40 && y >= 12 && y < 30, at_edge = x == 20 || x == 39;
    return inside ? (at_edge ? 7.25f : 20.0f) : 0.5f;
  };
  DenoiseInput input = noisy_image(64, 48, light, 0.1f, 4);
  for (int y = 12; y < 30; ++y)
    for (int x = 20; x < 40; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto i = std::size_t(y * 64 + x);
        input.half_a.plane(c)[i] = input.half_b.plane(c)[i] = input.color.plane(c)[i] = light(x, y, c);
        input.variance.plane(c)[i] = 0;
      }
  const auto denoised = nl_means(*test_device(), input, {});
  ASSERT_TRUE(denoised);
  for (int y = 12; y < 30; ++y)
    for (int x = 20; x < 40; ++x)
      EXPECT_NEAR(denoised->color.plane(1)[std::size_t(y * 64 + x)], light(x, y, 1), 1e-4) << x << " " << y;
}

TEST(NlMeans, FillsPixelsThatAreNotFinite) {
  DenoiseInput input = noisy_image(64, 48, constant, 0.1f, 5);
  const std::size_t hole = 20 * 64 + 30;
  input.valid.values[hole] = 0;
  for (Planes* planes : {&input.half_a, &input.half_b, &input.color})
    for (int c = 0; c < 3; ++c) planes->plane(c)[hole] = 0;
  const auto denoised = nl_means(*test_device(), input, {});
  ASSERT_TRUE(denoised);
  EXPECT_NEAR(denoised->color.plane(0)[hole], 0.5, 0.05);
  EXPECT_LT(rms_error(denoised->color, constant), 0.02);
}

TEST(NlMeans, IsTheSameInAWindowWithItsSurroundings) {
  const DenoiseInput input = noisy_image(150, 130, edge, 0.1f, 6);
  const NlMeansOptions options;
  const int halo = options.search_radius + options.patch_radius + kOutlierRadius;
  const auto whole = nl_means(*test_device(), input, options);
  const auto part =
      nl_means(*test_device(), crop(input, 37 - halo, 41 - halo, 50 + 2 * halo, 33 + 2 * halo), options);
  ASSERT_TRUE(whole && part);
  EXPECT_EQ(crop(whole->color, 37, 41, 50, 33).values, crop(part->color, halo, halo, 50, 33).values);
}

}  // namespace
}  // namespace penumbra
