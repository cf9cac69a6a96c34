// Alpha from a pixel's own samples: bias, error and variance of the estimates over many pixels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "tests/kernels/integrator/control_variate_pixels.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/statistics.h"

namespace penumbra::control_variate_statistics_test {
namespace {

constexpr double kRounding = 0x1p-24;   // of one operation in single precision
constexpr double kSignificance = 1e-3;  // of each statistical test; seeds are fixed
constexpr std::uint64_t kSeed = 20240;

/// Squared errors of the pixels' means.
statistics::Sample squared_errors(const Model& model, int n, int pixels) {
  RandomNumbers random(kSeed);
  Pixel pixel(n);
  statistics::Sample squares;
  for (int i = 0; i < pixels; ++i) {
    model.draw(random, pixel);
    const double error = pixel.estimates().mean() - model.mean();
    squares.add(error * error);
  }
  return squares;
}

statistics::Sample means(const Model& model, int n, int pixels) {
  RandomNumbers random(kSeed);
  Pixel pixel(n);
  statistics::Sample sample;
  for (int i = 0; i < pixels; ++i) {
    model.draw(random, pixel);
    sample.add(pixel.estimates().mean());
  }
  return sample;
}

TEST(ControlVariateStatistics, ManySamplesNearTheBestAlpha) {
  constexpr int kSamples = 4096, kPixels = 40;
  // The rule's prior weighs 4 samples in the 2048 of a half, and quotients of means of 2048 samples have a
  // bias of the order of their relative variance over 2048, below 4 / 2048 for these models.
  constexpr double kBias = 8.0 / 2048;
  for (const Model& model : {Model{.visible = .24}, Model{.visible = .9, .bright = true},
                             Model{.power = 1, .visible = .68}, Model{.visible = .5, .varying = true}}) {
    RandomNumbers random(kSeed);
    Pixel pixel(kSamples);
    statistics::Sample alphas;
    for (int i = 0; i < kPixels; ++i) {
      model.draw(random, pixel);
      alphas.add(pixel.auto_alpha(i & 1));
    }
    EXPECT_GT(std::abs(model.best() - model.visible), 0.05) << "the best is not the guess";
    EXPECT_GT(statistics::t_test(alphas, model.best(), kBias).p, kSignificance)
        << model.name() << ": " << alphas.mean() << " for " << model.best();
  }
}

TEST(ControlVariateStatistics, CrossFittingHasNoBias) {
  std::vector<Model> models;
  for (int power : {0, 2, 30}) {
    models.push_back({.power = power, .varying = true, .moving = true, .rays = 1});
    models.push_back({.power = power, .bright = true, .varying = true, .moving = true, .rays = 3});
    models.push_back({.power = power, .visible = 0.05, .rays = 1});
  }
  for (const Model& model : models)
    for (int n : {2, 3, 5, 16}) {
      const statistics::Sample sample = means(model, n, 200'000 / n);
      EXPECT_GT(statistics::t_test(sample, model.mean(), 8 * kRounding).p, kSignificance)
          << model.name() << ", n " << n << ": " << sample.mean() << " for " << model.mean();
    }
}

// What cross-fitting may cost over alpha = 0, and over the best of the fixed alphas 0, the visible fraction
// and alpha*, as factors of the root mean square error. The largest seen are within 4% (in 2e5 samples each):
// few samples cannot know whether the dim or the bright part of a light is hidden.
struct Cost {
  int n;
  double over_plain, over_best;

  friend void PrintTo(const Cost& cost, std::ostream* out) { *out << cost.n << " samples"; }
};

class CrossFittingCost : public testing::TestWithParam<Cost> {};

TEST_P(CrossFittingCost, IsBounded) {
  const auto [n, over_plain, over_best] = GetParam();
  std::vector<Model> models;
  for (double visible : {.01, .05, .24, .5, .68, .9})
    for (bool bright : {false, true}) {
      models.push_back({.power = 2, .visible = visible, .bright = bright});
      models.push_back({.power = 2, .visible = visible, .bright = bright, .varying = true});
      models.push_back({.power = 1, .visible = visible, .bright = bright});
    }
  for (double visible : {.01, .5}) models.push_back({.power = 0, .visible = visible, .varying = true});
  for (const Model& model : models) {
    const statistics::Sample squares = squared_errors(model, n, 100'000 / n);
    const double plain = model.variance(0) / n,
                 best =
                     std::min({plain, model.variance(model.visible) / n, model.variance(model.best()) / n});
    const double noise = 4 * squares.standard_error();
    EXPECT_LT(squares.mean(), over_plain * over_plain * plain + noise)
        << model.name() << ": " << std::sqrt(squares.mean() / plain);
    EXPECT_LT(squares.mean(), over_best * over_best * best + noise)
        << model.name() << ": " << std::sqrt(squares.mean() / best);
  }
}

INSTANTIATE_TEST_SUITE_P(Samples, CrossFittingCost,
                         testing::Values(Cost{4, 1.5, 1.95}, Cost{8, 1.24, 1.5}, Cost{16, 1.1, 1.22},
                                         Cost{64, 1.06, 1.08}),
                         [](const auto& cost) { return std::to_string(cost.param.n); });

TEST(ControlVariateStatistics, SpreadIsTheError) {
  // M2 / (n (n - 1)) is the variance of the mean for fixed alphas; fitted ones change it by O(1 / n) of
  // itself.
  constexpr int kSamples = 64, kPixels = 20'000;
  constexpr double kTolerance = 4.0 / kSamples;
  for (const Model& model : {Model{.visible = .24}, Model{.visible = .68, .varying = true},
                             Model{.visible = .5, .bright = true}}) {
    RandomNumbers random(kSeed);
    Pixel pixel(kSamples);
    statistics::Sample pixel_means, variances;
    for (int i = 0; i < kPixels; ++i) {
      model.draw(random, pixel);
      const statistics::Sample sample = pixel.estimates();
      pixel_means.add(sample.mean());
      variances.add(sample.variance() / kSamples);
    }
    // A sample variance of kPixels nearly normal means is known to sqrt(2 / kPixels): 1%.
    EXPECT_NEAR(variances.mean() / pixel_means.variance(), 1, kTolerance + 4 * std::sqrt(2.0 / kPixels))
        << model.name();
  }
}

/// One ray in 256 is worth 257 times the others.
struct Spikes {
  double spike_visible, rest_visible;  // probabilities

  static constexpr double kRare = 1.0 / 256, kRest = 0.5, kSpike = kRest + 0.5 / kRare;  // mean 1
  [[nodiscard]] double mean() const {
    return kRare * kSpike * spike_visible + (1 - kRare) * kRest * rest_visible;
  }
  [[nodiscard]] double variance() const {
    return kRare * kSpike * kSpike * spike_visible + (1 - kRare) * kRest * kRest * rest_visible -
           mean() * mean();
  }
  void draw(RandomNumbers& random, Pixel& pixel) const {
    for (std::size_t i = 0; i < pixel.h.size(); ++i) {
      const bool spike = random.uniform() < kRare;
      pixel.w[i] = float(spike ? kSpike : kRest);
      pixel.h[i] = random.uniform() < (spike ? spike_visible : rest_visible) ? pixel.w[i] : 0.0f;
      pixel.g[i] = 1;
    }
  }
};

TEST(ControlVariateStatistics, RareHugeWeights) {
  for (const Spikes& spikes : {Spikes{1, 1}, Spikes{0, 1}, Spikes{0, 0.5}, Spikes{1, 0}, Spikes{0.5, 0.5}})
    for (int n : {2, 3, 16, 64}) {
      RandomNumbers random(kSeed);
      Pixel pixel(n);
      statistics::Sample sample, squares;
      for (int i = 0; i < 400'000 / n; ++i) {
        spikes.draw(random, pixel);
        const double mean = pixel.estimates().mean();
        sample.add(mean);
        squares.add((mean - spikes.mean()) * (mean - spikes.mean()));
      }
      const std::string name = std::to_string(spikes.spike_visible) + ", " +
                               std::to_string(spikes.rest_visible) + ", n " + std::to_string(n);
      EXPECT_GT(statistics::t_test(sample, spikes.mean(), 256 * kRounding).p, kSignificance)
          << name << ": " << sample.mean() << " for " << spikes.mean();
      // Few samples cannot tell a hidden highlight from an unseen one; their error stays below that of the
      // light without shadows.
      const double worst = (spikes.variance() + Spikes{1, 1}.variance()) / n;
      EXPECT_LT(squares.mean(), worst + 4 * squares.standard_error()) << name;
      // Many can: half the rest is seen to be shadowed, and W falls short of G.
      if (n == 64 && spikes.spike_visible == 0 && spikes.rest_visible < 1) {
        EXPECT_LT(squares.mean(), 4 * spikes.variance() / n) << name;
      }
    }
}

}  // namespace
}  // namespace penumbra::control_variate_statistics_test
