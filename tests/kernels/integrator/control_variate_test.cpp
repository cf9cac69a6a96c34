// Alpha from a pixel's own samples: properties that hold for every pixel.
#include "kernels/integrator/control_variate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "tests/kernels/integrator/control_variate_pixels.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra::control_variate_test {
namespace {

constexpr double kRounding = 0x1p-24;  // of one operation in single precision

TEST(ControlVariate, FullyLitLeavesTheClosedForm) {
  RandomNumbers random(1);
  for (int n : {2, 3, 4, 16, 4096})
    for (int power : {0, 2, 30}) {
      Pixel pixel(n);
      Model{.power = power, .varying = true}.draw(random, pixel);
      pixel.h = pixel.w;
      for (float alpha : {pixel.auto_alpha(0), pixel.auto_alpha(1)}) {
        EXPECT_EQ(alpha, 1.0f);
        for (int i = 0; i < n; ++i) EXPECT_EQ(pixel.estimate(i, alpha), pixel.g[std::size_t(i)]);
      }
    }
}

TEST(ControlVariate, UmbraIsLeftAlone) {
  RandomNumbers random(2);
  for (int n : {1, 2, 3, 16, 4096}) {
    Pixel pixel(n);
    Model{}.draw(random, pixel);
    std::ranges::fill(pixel.h, 0.0f);
    for (float alpha : {pixel.auto_alpha(0), pixel.auto_alpha(1)}) EXPECT_EQ(alpha, 0.0f);
  }
}

TEST(ControlVariate, NothingKnownIsZero) {
  Pixel one(1);
  one.h = {0.5f};
  one.w = {1};
  one.g = {2};
  EXPECT_EQ(one.auto_alpha(0), 0.0f) << "the other half is empty";
  EXPECT_EQ(one.auto_alpha(1, 1), 0.0f) << "the other half is empty";
  EXPECT_EQ(one.auto_alpha(1), 0.5f / (1 + 0.25f)) << "of the 1 that is missed, (1 / 2)^2 is dark";
  Pixel none(8);
  EXPECT_EQ(none.auto_alpha(0), 0.0f);
  std::ranges::fill(none.g, 1.0f);
  EXPECT_EQ(none.auto_alpha(0), 0.0f) << "no ray with any light";
}

TEST(ControlVariate, DependsOnTheOtherHalfAlone) {
  RandomNumbers random(3);
  constexpr int kFirst = 5;  // the array has other pixels' samples before and behind
  for (int count : {2, 3, 7, 16})
    for (int parity : {0, 1})
      for (int half : {0, 1}) {
        Pixel pixel(kFirst + count + 3);
        Model{}.draw(random, pixel);
        Pixel other = pixel;
        for (int i = 0; i < other.count(); ++i) {
          const bool inside = i >= kFirst && i < kFirst + count;
          if (inside && ((i - kFirst + parity) & 1) != half) continue;
          other.h[std::size_t(i)] = other.w[std::size_t(i)] = other.g[std::size_t(i)] = 1e30f;
        }
        const auto alpha = [&](const Pixel& p) {
          return cross_fitted_alpha(p.h.data() + kFirst, p.w.data() + kFirst, p.g.data() + kFirst, 1, count,
                                    parity, half);
        };
        EXPECT_EQ(alpha(pixel), alpha(other)) << count << ", " << parity << ", " << half;
        // So do they alone, among samples of no light.
        Pixel alone(2 * count);
        int used = 0;
        for (int i = kFirst; i < kFirst + count; ++i)
          if (((i - kFirst + parity) & 1) != half) alone.copy(2 * used++ + 1, pixel, i);
        EXPECT_EQ(alpha(pixel), alone.auto_alpha(0));
        EXPECT_GT(used, 0);
      }
}

TEST(ControlVariate, ScaleIsFree) {
  RandomNumbers random(4);
  for (int n : {2, 8, 64})
    for (int power : {0, 2})
      for (double exponent : {-90.0, -60.0, -1.0, 1.0, 60.0, 90.0}) {
        Pixel pixel(n);
        Model{.power = power, .varying = true}.draw(random, pixel);
        Pixel scaled = pixel;
        for (auto* values : {&scaled.h, &scaled.w, &scaled.g})
          for (float& value : *values) value *= float(std::exp2(exponent));
        EXPECT_EQ(scaled.auto_alpha(0), pixel.auto_alpha(0));
        EXPECT_EQ(scaled.auto_alpha(1), pixel.auto_alpha(1));
      }
  for (float scale : {std::numeric_limits<float>::min(), 1e-30f, 1e30f, std::numeric_limits<float>::max()}) {
    Pixel pixel(4);
    pixel.h = {0.25f * scale, 0, 0.5f * scale, 0.125f * scale};
    pixel.w = {0.5f * scale, 0.25f * scale, scale, 0.25f * scale};
    pixel.g = {0.5f * scale, scale, 0.75f * scale, 0.25f * scale};
    EXPECT_TRUE(std::isfinite(pixel.auto_alpha(0)) && std::isfinite(pixel.auto_alpha(1)));
  }
}

TEST(ControlVariate, WideRangesStayFinite) {
  RandomNumbers random(5);
  const auto wide = [&random] { return float(std::pow(10.0, random.between(-38, 38.5))); };
  for (int i = 0; i < 20'000; ++i) {
    Pixel pixel(2 + int(random.below(10)));
    for (std::size_t s = 0; s < pixel.h.size(); ++s) {
      pixel.w[s] = random.below(8) == 0 ? 0.0f : wide();
      pixel.g[s] = random.below(8) == 0 ? 0.0f : wide();
      pixel.h[s] = random.below(2) == 0 ? 0.0f : float(random.uniform()) * pixel.w[s];
    }
    for (float alpha : {pixel.auto_alpha(0), pixel.auto_alpha(1)}) EXPECT_TRUE(std::isfinite(alpha));
  }
}

TEST(ControlVariate, ConstantWeightsChangeNothing) {
  RandomNumbers random(7);
  constexpr double kNoise = 1e-6;  // of W about G, as rounding makes it
  for (int n : {2, 3, 16, 256})
    for (double noise : {0.0, kNoise})
      for (int i = 0; i < 200; ++i) {
        Pixel pixel(n);
        Model{.power = 0, .visible = .3, .varying = true}.draw(random, pixel);
        for (float& w : pixel.w) w *= float(1 + random.between(-noise, noise));
        for (std::size_t s = 0; s < pixel.h.size(); ++s) pixel.h[s] = std::min(pixel.h[s], pixel.w[s]);
        for (int half : {0, 1}) {
          const float alpha = pixel.auto_alpha(half);
          // |H - v W| <= G and |C| <= kNoise G, so the regression is at most kNoise over the floor, 1.
          EXPECT_LE(std::abs(alpha), 2.2);
          for (int s = half; s < n; s += 2) {
            const double g = pixel.g[std::size_t(s)];
            EXPECT_NEAR(pixel.estimate(s, alpha), pixel.h[std::size_t(s)], 2.2 * g * (noise + 5 * kRounding));
          }
        }
      }
}

TEST(ControlVariate, MissedHighlightsCountAsDark) {
  Pixel pixel(16);
  std::ranges::fill(pixel.g, 1.0f);
  std::ranges::fill(pixel.w, 0.01f);
  for (std::size_t s = 0; s < 16; ++s) pixel.h[s] = s % 4 < 2 ? 0.01f : 0.0f;
  // v = 1/2 is known of a hundredth of the light, and nothing of what the rest does.
  EXPECT_LT(std::abs(pixel.auto_alpha(0)), 0.02);
  // A shortfall of a twentieth among samples that vary by a half is chance.
  for (std::size_t s = 0; s < 16; ++s) {
    pixel.w[s] = s % 8 < 4 ? 0.5f : 1.4f;
    pixel.h[s] = s % 4 < 2 ? pixel.w[s] : 0.0f;
  }
  EXPECT_NEAR(pixel.auto_alpha(0), 0.5, 0.01);
  pixel.h = pixel.w;
  EXPECT_EQ(pixel.auto_alpha(0), 1.0f) << "nothing says that there is a shadow";
}

}  // namespace
}  // namespace penumbra::control_variate_test
