// The counts of object or material IDs (mattes) that a film's samples hit: sums do not depend on the order of
// tiles, the number of IDs per pixel is bounded, and damaged bytes are refused.
#include "scheduler/plan/film_mattes.h"

#include <gtest/gtest.h>

#include <random>

#include "scheduler/plan/film_accumulator.h"
#include "tests/support/film_layers.h"

namespace penumbra {
namespace {

constexpr int kMattes = 200;

/// A pixel's result whose samples met these mattes.
SampleBuffer met(const std::vector<std::uint32_t>& mattes, float radiance = 0) {
  std::map<std::uint32_t, std::uint32_t> counts;
  for (const std::uint32_t matte : mattes) ++counts[matte];
  SampleBuffer buffer{.width = 1,
                      .height = 1,
                      .planes = kNoLayers.planes(),
                      .sample_count = std::uint32_t(mattes.size()),
                      .values = {radiance, radiance, radiance, 0, 0, 0}};
  buffer.mattes = {std::uint32_t(counts.size())};
  for (const auto& [matte, count] : counts) buffer.mattes.insert(buffer.mattes.end(), {matte, count});
  return buffer;
}

FilmAccumulator film_of_pixel() { return {0, 0, 1, 1, FilmLayers(0, kMattes)}; }

TEST(FilmMattes, AreTheSumsOfAllSamples) {
  FilmAccumulator film = film_of_pixel();
  std::mt19937 random(5);
  std::map<std::uint64_t, double> expected;
  for (int pass = 0; pass < 50; ++pass) {
    std::vector<std::uint32_t> mattes;
    for (int i = 0; i < 16; ++i) mattes.push_back(random() % 20);
    for (const std::uint32_t matte : mattes)
      if (matte != NO_MATTE) ++expected[matte];
    film.add(0, 0, met(mattes));
  }
  const auto there = film.mattes(0, 0);
  ASSERT_EQ(there.size(), expected.size());
  for (const MatteWeight& each : there) EXPECT_EQ(each.weight, expected.at(each.matte)) << each.matte;
  film.clear(0, 0, 1, 1);
  EXPECT_TRUE(film.mattes(0, 0).empty());
}

TEST(FilmMattes, ThoseThatCameFirstCountWhereThereAreTooMany) {
  FilmAccumulator film = film_of_pixel();
  for (std::uint32_t matte = kMattes; matte >= 1; --matte) film.add(0, 0, met({matte}));
  film.add(0, 0, met({1, kMattes}));
  const auto there = film.mattes(0, 0);
  ASSERT_EQ(there.size(), kMostMattesOfPixel);
  EXPECT_EQ(there.back().matte, std::uint64_t(kMattes));
  EXPECT_EQ(there.back().weight, 2);
  EXPECT_EQ(there.front().matte, kMattes - kMostMattesOfPixel + 1);
}

TEST(FilmMattes, OfAMeanOfHalvesAreTheMeanOfTheirShares) {
  FilmAccumulator film = film_of_pixel(), a = film_of_pixel(), b = film_of_pixel();
  a.add(0, 0, met({1, 1, 2, 3}));
  b.add(0, 0, met({1, 2}));
  film.set_mean_of(a, b);
  const double n = 6;
  ASSERT_EQ(film.mattes(0, 0).size(), 3u);
  EXPECT_DOUBLE_EQ(film.mattes(0, 0)[0].weight / n, 0.5);
  EXPECT_DOUBLE_EQ(film.mattes(0, 0)[1].weight / n, 0.375);
  EXPECT_DOUBLE_EQ(film.mattes(0, 0)[2].weight / n, 0.125);
  film.set_mean_of(a, film_of_pixel());
  EXPECT_EQ(film.mattes(0, 0)[0].weight, 2) << "of one half alone";
}

TEST(FilmMattes, BelongToTheHash) {
  FilmAccumulator a = film_of_pixel(), b = film_of_pixel(), without(0, 0, 1, 1, kNoLayers);
  a.add(0, 0, met({1, 2}));
  b.add(0, 0, met({1, 1}));
  without.add(0, 0, met({1, 2}));
  EXPECT_NE(a.hash(), b.hash());
  b.clear(0, 0, 1, 1);
  b.add(0, 0, met({2, 1}));
  EXPECT_EQ(a.hash(), b.hash());
  EXPECT_TRUE(without.mattes(0, 0).empty());
}

std::vector<std::uint8_t> bytes_of_film(const FilmAccumulator& film) {
  std::vector<std::uint8_t> bytes;
  ByteWriter writer(bytes);
  film.write(writer);
  return bytes;
}

TEST(FilmMattes, AreReadAsTheyWereWritten) {
  FilmAccumulator film = film_of_pixel();
  film.add(0, 0, met({1, 1, 7, NO_MATTE}));
  const std::vector<std::uint8_t> bytes = bytes_of_film(film);
  EXPECT_LE(bytes.size(), film.most_written() + 1000);
  FilmAccumulator there = film_of_pixel();
  ByteReader reader(bytes);
  ASSERT_TRUE(there.read(reader));
  EXPECT_EQ(there.hash(), film.hash());
  EXPECT_EQ(bytes_of_film(there), bytes);
}

TEST(FilmMattes, DamagedBytesAreRefused) {
  FilmAccumulator film = film_of_pixel();
  film.add(0, 0, met({1, 1, 7, NO_MATTE}));
  const std::vector<std::uint8_t> bytes = bytes_of_film(film);
  // The numbers before: five of the film, seven of the pixel. Then how many mattes, and two of them.
  const std::size_t mattes = 8 * (5 + 7);
  const auto with = [&](std::size_t word, auto value) {
    std::vector<std::uint8_t> changed = bytes, number;
    ByteWriter writer(number);
    if constexpr (std::is_same_v<decltype(value), double>)
      writer.f64(value);
    else
      writer.u64(value);
    std::ranges::copy(number, changed.begin() + std::ptrdiff_t(mattes + 8 * word));
    FilmAccumulator there = film_of_pixel();
    ByteReader reader(changed);
    return there.read(reader).has_value();
  };
  EXPECT_TRUE(with(0, std::uint64_t(2))) << "as it is";
  EXPECT_FALSE(with(0, std::uint64_t(1) << 60));
  EXPECT_FALSE(with(0, std::uint64_t(kMostMattesOfPixel)));
  EXPECT_FALSE(with(1, std::uint64_t(NO_MATTE)));
  EXPECT_FALSE(with(1, std::uint64_t(7))) << "twice";
  EXPECT_FALSE(with(3, std::uint64_t(kMattes + 1)));
  EXPECT_FALSE(with(2, -1.0));
  EXPECT_FALSE(with(2, 0.0));
  EXPECT_FALSE(with(2, 1e300)) << "more than its samples";
  EXPECT_FALSE(with(2, std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace
}  // namespace penumbra
