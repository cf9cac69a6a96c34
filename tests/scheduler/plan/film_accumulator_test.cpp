#include "scheduler/plan/film_accumulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "scheduler/plan/byte_stream.h"
#include "tests/support/film_layers.h"

namespace penumbra {
namespace {

/// Statistics of one pixel's samples, all channels alike, computed in two passes in extended precision.
struct Reference {
  long double mean = 0, m2 = 0;
};

Reference two_pass(const std::vector<double>& samples) {
  Reference reference;
  for (const double sample : samples) reference.mean += sample;
  reference.mean /= static_cast<long double>(samples.size());
  for (const double sample : samples) {
    const long double deviation = sample - reference.mean;
    reference.m2 += deviation * deviation;
  }
  return reference;
}

/// A result of one pixel whose radiance statistics are exactly the given floats.
SampleBuffer pixel_result(float mean, float deviation, std::uint32_t count) {
  SampleBuffer buffer{
      .width = 1, .height = 1, .planes = kNoLayers.planes(), .sample_count = count, .values = {}};
  buffer.values = {mean, mean, mean, deviation, deviation, deviation};
  return buffer;
}

// The float means and deviations of the units are taken as exact: the units' samples are chosen so that they
// are. A unit of two samples a, b with a + b and (a - b) / 2 representable is such.
TEST(FilmAccumulator, MergedStatisticsAreThoseOfAllSamples) {
  std::mt19937 random(20240611);
  std::uniform_int_distribution<int> middle(0, 4095), half_distance(0, 1023);
  FilmAccumulator film(0, 0, 1, 1, kNoLayers);
  std::vector<double> samples;
  constexpr int kUnits = 20000;
  for (int i = 0; i < kUnits; ++i) {
    const double m = middle(random) / 1024.0, d = half_distance(random) / 1024.0;
    samples.insert(samples.end(), {m - d, m + d});
    film.add(0, 0, pixel_result(float(m), float(d), 2));
  }
  const Reference reference = two_pass(samples);
  const PixelStatistics& pixel = film.at(0, 0);
  EXPECT_EQ(pixel.count, samples.size());
  // Each of the n merges rounds a few times, relative to values no larger than the final ones.
  const double tolerance = 4 * kUnits * 0x1p-53;
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(pixel.mean[c], double(reference.mean), tolerance * double(reference.mean));
    EXPECT_NEAR(pixel.m2[c], double(reference.m2), tolerance * double(reference.m2));
  }
}

TEST(FilmAccumulator, UnequalUnitsAreWeightedByTheirCounts) {
  FilmAccumulator film(0, 0, 1, 1, kNoLayers);
  film.add(0, 0, pixel_result(1, 0, 3));  // 1 1 1
  film.add(0, 0, pixel_result(5, 1, 2));  // 4 6
  EXPECT_EQ(film.at(0, 0).count, 5u);
  EXPECT_NEAR(film.at(0, 0).mean[1], 13.0 / 5, 1e-15);
  EXPECT_NEAR(film.at(0, 0).m2[1], 3 + 16 + 36 - 169.0 / 5, 1e-13);
}

TEST(FilmAccumulator, ALargeOffsetDoesNotDrownTheVariance) {
  // Sum of squares minus squared sum would lose all digits here: 1e6^2 / 1e-2^2 = 1e16.
  FilmAccumulator film(0, 0, 1, 1, kNoLayers);
  constexpr int kUnits = 1000;
  for (int i = 0; i < kUnits; ++i) film.add(0, 0, pixel_result(1e6f, 1e-2f, 2));
  EXPECT_NEAR(film.at(0, 0).m2[0], kUnits * 2 * double(1e-2f) * double(1e-2f), 1e-9);
}

TEST(FilmAccumulator, ManySamplesKeepTheirPrecision) {
  FilmAccumulator film(0, 0, 1, 1, kNoLayers);
  constexpr std::uint32_t kSamples = 4096;
  constexpr std::uint64_t kUnits = 25000;  // 1e8 samples
  for (std::uint64_t i = 0; i < kUnits; ++i)
    film.add(0, 0, pixel_result(i % 2 == 0 ? 0.25f : 0.75f, 1.0f / 64, kSamples));
  EXPECT_EQ(film.at(0, 0).count, kUnits * kSamples);
  EXPECT_NEAR(film.at(0, 0).mean[2], 0.5, 1e-12);
  const double m2 = double(kUnits) + double(kUnits * kSamples) / 16;
  EXPECT_NEAR(film.at(0, 0).m2[2], m2, 1e-11 * m2);
}

TEST(FilmAccumulator, FeaturesAreAveraged) {
  FilmAccumulator film(10, 20, 2, 1, kPolygonLayers);
  const auto result = [](float value, std::uint32_t count) {
    SampleBuffer buffer{
        .width = 1, .height = 1, .planes = kPolygonLayers.planes(), .sample_count = count, .values = {}};
    for (int plane = 0; plane < kPolygonLayers.planes(); ++plane)
      buffer.values.push_back(value * float(plane + 1));
    return buffer;
  };
  film.add(11, 20, result(1, 1));
  film.add(11, 20, result(4, 2));  // the mean of 1, 4, 4 is 3
  for (int layer = 0; layer < LAYER_COVERAGE; ++layer)
    for (int plane = 0; kPolygonLayers.has(layer) && plane < kFilmLayers[layer].planes; ++plane)
      EXPECT_NEAR(film.layer(11, 20, layer, plane), 3.0 * (kPolygonLayers.plane(layer) + plane + 1), 1e-14);
  EXPECT_EQ(film.at(10, 20).count, 0u);
}

TEST(FilmAccumulator, RelativeErrorIsTheStatedFormula) {
  FilmAccumulator film(0, 0, 2, 1, kNoLayers);
  EXPECT_TRUE(std::isnan(film.relative_error()));
  film.add(0, 0, pixel_result(2, 0, 1));
  EXPECT_TRUE(std::isnan(film.relative_error())) << "one sample says nothing about its error";
  film.add(0, 0, pixel_result(4, 0, 1));  // mean 3, m2 2, SE^2 = 2 / (2 * 1) = 1
  EXPECT_NEAR(film.relative_error(), std::sqrt(1 / 9.01), 1e-15);
  film.add(1, 0, pixel_result(0, 2, 3));  // SE^2 = 12 / (3 * 2) = 2
  EXPECT_NEAR(film.relative_error(), std::sqrt((1 / 9.01 + 2 / 0.01) / 2), 1e-13);
}

TEST(FilmAccumulator, ClearForgetsOneRectangle) {
  SampleBuffer result{.width = 2,
                      .height = 2,
                      .planes = kNoLayers.planes(),
                      .sample_count = 1,
                      .flagged = {{{.count = 3, .x = 5, .y = 4, .sample = 7, .source = {SOURCE_LIGHT, 2}},
                                   {.count = 1, .x = 0, .y = 0, .sample = 0, .source = {}},
                                   {.count = 2, .x = 5, .y = 5, .sample = 1, .source = {}, .shape = 9}}},
                      .values = std::vector<float>(4 * kNoLayers.planes(), 1.0f)};
  FilmAccumulator film(4, 4, 4, 2, kNoLayers);
  film.add(4, 4, result);
  const std::uint64_t before = film.hash();
  film.add(6, 4, result);
  EXPECT_EQ(film.flagged()[BAD_NAN].count, 6u);
  EXPECT_NE(film.hash(), before);
  film.clear(6, 4, 2, 2);
  EXPECT_EQ(film.hash(), before);
  EXPECT_EQ(film.flagged()[BAD_NAN], result.flagged[BAD_NAN]);
  EXPECT_EQ(film.flagged()[BAD_INFINITE].count, 1u);
  EXPECT_EQ(film.flagged()[BAD_BOUNDARY], result.flagged[BAD_BOUNDARY]);
}

TEST(FilmAccumulator, TheFirstNonFiniteSampleDoesNotDependOnTheOrder) {
  const auto result = [](int x, int y, std::uint32_t sample, int source) {
    return SampleBuffer{.width = 2,
                        .height = 2,
                        .planes = kNoLayers.planes(),
                        .sample_count = 1,
                        .flagged = {{{.count = 1, .x = x, .y = y, .sample = sample, .source = {source, 0}}}},
                        .values = std::vector<float>(4 * kNoLayers.planes(), 1.0f)};
  };
  // By row, then column, then sample.
  const SampleBuffer first = result(5, 5, 3, SOURCE_LIGHT), later = result(5, 5, 4, SOURCE_FILTER),
                     right = result(6, 5, 0, SOURCE_CONTROL), below = result(4, 6, 0, SOURCE_CAMERA);
  std::vector<SampleBuffer> all{first, later, right, below};
  for (int order = 0; order < 4; ++order) {
    FilmAccumulator film(4, 4, 4, 4, kNoLayers);
    for (const SampleBuffer& one : all)
      film.add(one.flagged[BAD_NAN].x / 2 * 2, one.flagged[BAD_NAN].y / 2 * 2, one);
    EXPECT_EQ(film.flagged()[BAD_NAN].count, 4u);
    EXPECT_EQ(film.flagged()[BAD_NAN].x, 5);
    EXPECT_EQ(film.flagged()[BAD_NAN].y, 5);
    EXPECT_EQ(film.flagged()[BAD_NAN].sample, 3u);
    EXPECT_EQ(film.flagged()[BAD_NAN].source, (NonFiniteSource{SOURCE_LIGHT, 0}));
    EXPECT_EQ(film.flagged()[BAD_INFINITE].count, 0u);
    std::ranges::rotate(all, all.begin() + 1);
  }
}

TEST(FilmAccumulator, FlaggedSamplesThatCannotBeAreNotRead) {
  const auto read_again = [](const FlaggedSamples& samples) {
    SampleBuffer buffer = pixel_result(1, 0, 2);
    buffer.flagged[BAD_BOUNDARY] = samples;
    FilmAccumulator film(0, 0, 1, 1, kNoLayers), again(0, 0, 1, 1, kNoLayers);
    film.add(0, 0, buffer);
    std::vector<std::uint8_t> bytes;
    ByteWriter writer(bytes);
    film.write(writer);
    ByteReader reader(bytes);
    const Expected<void> read = again.read(reader);
    if (read) EXPECT_EQ(again.flagged()[BAD_BOUNDARY], samples);
    return read ? std::string() : read.error().message;
  };
  const FlaggedSamples good{.count = 1, .sample = 1, .source = {SOURCE_FILTER, 3}, .shape = 7};
  EXPECT_EQ(read_again(good), "");
  std::vector<FlaggedSamples> wrong(5, good);
  wrong[0].source.where = SOURCE_FILTER + 1;
  wrong[1].source.where = -1;
  wrong[2].source.step = -1;
  wrong[3].shape = -1;
  wrong[4].x = 1;
  for (const FlaggedSamples& samples : wrong)
    EXPECT_EQ(read_again(samples), "a flagged sample that cannot be");
}

}  // namespace
}  // namespace penumbra
