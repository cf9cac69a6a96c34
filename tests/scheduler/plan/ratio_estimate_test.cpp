#include "scheduler/plan/ratio_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "scheduler/plan/film_accumulator.h"

namespace penumbra {
namespace {

/// Plain light p, and H, W and G of polygon lights.
struct LightSample {
  double p, h, w, g;
};

std::vector<LightSample> random_samples(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform;
  std::vector<LightSample> samples;
  for (int i = 0; i < count; ++i) {
    const double w = 3 * std::pow(uniform(random), 2);
    samples.push_back({uniform(random), uniform(random) < 0.4 ? w : 0, w, 0.5 + uniform(random)});
  }
  return samples;
}

double ratio_of(std::span<const LightSample> samples) {
  double h = 0, w = 0;
  for (const LightSample& s : samples) h += s.h, w += s.w;
  return w > 0 ? h / w : 0;
}

RatioPart part_of(std::span<const LightSample> samples) {
  const double r = ratio_of(samples), n = double(samples.size());
  RatioPart part{.count = samples.size(), .ratio = r};
  for (const LightSample& s : samples) {
    part.mean += (s.p + s.h + r * (s.g - s.w)) / n;
    part.b += (s.g - s.w) / n;
    part.w += s.w / n;
    part.difference += (s.h - s.g + r * (s.g - s.w)) / n;
  }
  double products = 0;
  for (const LightSample& s : samples) {
    const double a = s.p + s.h + r * (s.g - s.w) - part.mean, b = s.g - s.w - part.b;
    part.deviation += a * a / n;
    part.deviation_b += b * b / n;
    products += a * b / n;
  }
  part.deviation = std::sqrt(part.deviation);
  part.deviation_b = std::sqrt(part.deviation_b);
  const double both = part.deviation * part.deviation_b;
  part.correlation = both > 0 ? products / both : 0;
  return part;
}

TEST(RatioSums, OfAnyPartsAreThoseOfAllSamples) {
  const std::vector<LightSample> samples = random_samples(840);
  const RatioPart all = part_of(samples);
  for (const std::size_t size : {1u, 2u, 3u, 7u, 40u, 420u, 840u}) {
    RatioSums sums;
    for (std::size_t k = 0; k < samples.size(); k += size)
      sums.add(part_of(std::span(samples).subspan(k, size)));
    EXPECT_NEAR(sums.mean(), all.mean, 1e-13) << size;
    EXPECT_NEAR(sums.m2(), all.deviation * all.deviation * 840, 1e-10) << size;
    EXPECT_NEAR(sums.difference(), all.difference, 1e-13) << size;
  }
}

TEST(RatioSums, OnePartIsLeftAlone) {
  const RatioPart part = part_of(random_samples(16));
  RatioSums sums;
  sums.add(part);
  EXPECT_EQ(sums.mean(), part.mean);
  EXPECT_EQ(sums.m2(), part.deviation * part.deviation * 16);
  EXPECT_EQ(sums.difference(), part.difference);
}

TEST(RatioSums, WhereAllIsLitOrDarkNothingIsNoise) {
  std::vector<LightSample> lit = random_samples(64), dark = lit;
  for (LightSample& s : lit) s = {.p = 0, .h = s.w, .w = s.w, .g = 1};
  for (LightSample& s : dark) s = {.p = 0, .h = 0, .w = s.w, .g = 1};
  RatioSums sums_lit, sums_dark;
  for (std::size_t k = 0; k < 64; k += 4) {
    sums_lit.add(part_of(std::span(lit).subspan(k, 4)));
    sums_dark.add(part_of(std::span(dark).subspan(k, 4)));
  }
  EXPECT_NEAR(sums_lit.mean(), 1, 1e-15);
  EXPECT_NEAR(sums_lit.m2(), 0, 1e-28);
  EXPECT_EQ(sums_dark.mean(), 0);
  EXPECT_EQ(sums_dark.m2(), 0);
}

TEST(RatioSums, AFilmForgetsThemWithItsSamples) {
  const auto result = [](float mean, float ratio) {
    SampleBuffer buffer{.width = 1,
                        .height = 1,
                        .planes = kRadiancePlanes + int(kRatioPlanes),
                        .sample_count = 4,
                        .values = {}};
    buffer.values.assign(std::size_t(buffer.planes), 0.0f);
    for (std::size_t c = 0; c < 3; ++c) {
      buffer.values[std::size_t(kMeanR) + c] = mean;
      buffer.values[std::size_t(kRadiancePlanes) + std::size_t(kRatioMeanR) + c] = 1;
      buffer.values[std::size_t(kRadiancePlanes) + std::size_t(kRatioR) + c] = ratio;
      buffer.values[std::size_t(kRadiancePlanes) + std::size_t(kRatioUnshadowedR) + c] = 2;
    }
    return buffer;
  };
  FilmAccumulator film(0, 0, 1, 1, kRadiancePlanes, true);
  film.add(0, 0, result(1, 0.25f));
  film.add(0, 0, result(2, 0.75f));
  // Each mean is moved to the ratio of both, 1/2: (1 + 1/4 + 2 - 1/4) / 2.
  EXPECT_DOUBLE_EQ(film.at(0, 0).mean[1], 1.5);
  film.clear(0, 0, 1, 1);
  film.add(0, 0, result(2, 0.75f));
  EXPECT_EQ(film.at(0, 0).mean[1], 2);
  EXPECT_EQ(film.at(0, 0).count, 4u);
}

}  // namespace
}  // namespace penumbra
