// Tiles that stop when their error reaches the target: the stopping rule has no bias where a simple rule has
// one, and each tile reaches the target.
#include "scheduler/plan/adaptive_tile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "scheduler/plan/merge.h"
#include "tests/support/film_layers.h"

namespace penumbra {
namespace {

constexpr int kSide = 4;  // of a tile
constexpr std::uint32_t kPerPass = 4;

/// Samples that are 1 with the probability p and 0 otherwise: rare bright ones, all that fireflies are.
SampleBuffer bernoulli_pass(std::mt19937_64& random, double p, int size = kSide) {
  SampleBuffer result{.width = size,
                      .height = size,
                      .planes = kNoLayers.planes(),
                      .sample_count = kPerPass,
                      .values = std::vector<float>(std::size_t(size) * size * kNoLayers.planes())};
  std::binomial_distribution<int> hits(int(kPerPass), p);
  for (std::size_t pixel = 0; pixel < result.pixels(); ++pixel) {
    const double mean = hits(random) / double(kPerPass);
    for (int c = 0; c < 3; ++c) {
      result.plane(c)[pixel] = float(mean);
      result.plane(kDeviationR + c)[pixel] = float(std::sqrt(mean * (1 - mean)));
    }
  }
  return result;
}

FilmAccumulator empty_film(int size = kSide) { return {0, 0, size, size, kNoLayers}; }

double mean_of(const FilmAccumulator& film) {
  double sum = 0;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) sum += film.at(x, y).mean[0];
  return sum / (film.width() * film.height());
}

struct Moments {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double value) { sum += value, squares += value * value, ++count; }
  [[nodiscard]] double mean() const { return sum / count; }
  /// Of the mean against the truth.
  [[nodiscard]] double t(double truth) const {
    const double variance = (squares - sum * sum / count) / (count - 1);
    return (mean() - truth) / std::sqrt(variance / count);
  }
};

constexpr std::uint32_t kMostPasses = 400;
constexpr double kProbability = 0.002, kTarget = 0.05;

double adaptive_mean(std::mt19937_64& random, double& passes) {
  AdaptiveTile tile(empty_film(), kTarget, kMostPasses);
  std::uint32_t pass = 0;
  do tile.add(pass, bernoulli_pass(random, kProbability));
  while (!tile.decide(++pass));
  passes += pass;
  FilmAccumulator film = empty_film();
  tile.put_into(film);
  return mean_of(film);
}

/// Stops at the same numbers of passes, by the error of all that it has.
double naive_mean(std::mt19937_64& random, double& passes) {
  FilmAccumulator film = empty_film();
  std::uint32_t pass = 0;
  for (std::uint32_t decision = 0; pass < kMostPasses;) {
    decision = AdaptiveTile::next_decision(pass, kMostPasses);
    for (; pass < decision; ++pass) film.add(0, 0, bernoulli_pass(random, kProbability));
    if (film.relative_error() <= kTarget) break;
  }
  passes += pass;
  return mean_of(film);
}

TEST(AdaptiveTile, StoppingLeavesNoBiasWhereTheSimpleRuleDoes) {
  constexpr int kRepetitions = 50000;
  std::mt19937_64 random(1);
  Moments adaptive, naive;
  double adaptive_passes = 0, naive_passes = 0;
  for (int i = 0; i < kRepetitions; ++i) {
    adaptive.add(adaptive_mean(random, adaptive_passes));
    naive.add(naive_mean(random, naive_passes));
  }
  // Two-sided, p = 0.0027 for the right rule; the wrong one is to be seen beyond any doubt.
  EXPECT_LT(std::abs(adaptive.t(kProbability)), 3.0) << adaptive.mean();
  EXPECT_LT(naive.t(kProbability), -10.0) << naive.mean();
  // Neither rule always stops at its first chance, nor never: the test would say nothing.
  EXPECT_GT(adaptive_passes / kRepetitions, 6);
  EXPECT_LT(adaptive_passes / kRepetitions, double(kMostPasses) / 2);
  RecordProperty("adaptive_mean_over_truth", std::to_string(adaptive.mean() / kProbability));
  RecordProperty("naive_mean_over_truth", std::to_string(naive.mean() / kProbability));
  RecordProperty("adaptive_t", std::to_string(adaptive.t(kProbability)));
  RecordProperty("naive_t", std::to_string(naive.t(kProbability)));
  RecordProperty("adaptive_passes", std::to_string(adaptive_passes / kRepetitions));
}

TEST(AdaptiveTile, DecisionsAreAtFixedEvenNumbersOfPasses) {
  std::uint32_t at = 0;
  int decisions = 0;
  for (; at < 4001; ++decisions) {
    const std::uint32_t next = AdaptiveTile::next_decision(at, 4001);
    ASSERT_GT(next, at);
    ASSERT_TRUE(next % 2 == 0 || next == 4001);
    ASSERT_LE(next, std::max(at + 4, at + at / 4)) << "at most a quarter more";
    ASSERT_EQ(AdaptiveTile::next_decision(next - 1, 4001), next);
    at = next;
  }
  EXPECT_LT(decisions, 40);
}

constexpr int kFilm = 12;  // three by three tiles
TileGrid grid() { return {0, 0, kFilm, kFilm, kSide, kMostPasses * kPerPass, kPerPass}; }

/// The pass of a tile, always the same; those further right and down are noisier.
SampleBuffer pass_of(std::uint32_t tile, std::uint32_t pass) {
  std::mt19937_64 random(tile * 100003ull + pass);
  return bernoulli_pass(random, 0.02 + 0.05 * double(tile));
}

Merge rendered(double target) {
  Merge merge({0, 0, kFilm, kFilm, kNoLayers}, grid(), {.target_error = target});
  for (std::uint32_t tile = 0; tile < grid().tiles(); ++tile)
    for (std::uint32_t pass = 0; pass < merge.passes_wanted(tile); ++pass)
      merge.add(tile, pass, pass_of(tile, pass));
  return merge;
}

TEST(AdaptiveMerge, EachTileComesToTheTargetByItself) {
  const double target = 0.2;
  const Merge merge = rendered(target);
  EXPECT_TRUE(merge.is_done());
  EXPECT_LE(merge.film().relative_error(), 1.1 * target) << "halves differ by chance";
  EXPECT_GE(merge.film().relative_error(), 0.7 * target);
  const auto passes = merge.merged_passes();
  EXPECT_LT(*std::ranges::min_element(passes), *std::ranges::max_element(passes));
  EXPECT_LT(*std::ranges::max_element(passes), kMostPasses);
  EXPECT_EQ(merge.samples_expected(), merge.samples());
}

TEST(AdaptiveMerge, ComesToTheSameFilmInAnyOrderAndFromAnyCheckpoint) {
  const Merge undisturbed = rendered(0.2);
  std::mt19937 random(5);
  for (int trial = 0; trial < 20; ++trial) {
    Merge merge({0, 0, kFilm, kFilm, kNoLayers}, grid(), {.target_error = 0.2});
    std::vector<std::uint32_t> issued(grid().tiles());
    const auto interruption = trial % 2 == 0 ? random() % 200 : ~0ull;
    for (std::uint64_t unit = 0; !merge.is_done(); ++unit) {
      if (unit == interruption) {
        std::vector<std::uint8_t> bytes;
        ByteWriter writer(bytes);
        merge.write(writer);
        Merge resumed({0, 0, kFilm, kFilm, kNoLayers}, grid(), {.target_error = 0.2});
        ByteReader reader(bytes);
        const auto read = resumed.read(reader);
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_EQ(reader.left(), 0u);
        EXPECT_EQ(resumed.film().hash(), merge.film().hash());
        merge = std::move(resumed);
        issued = merge.merged_passes();
      }
      const auto tile = std::uint32_t(random() % grid().tiles());
      // Some come too many, as after a tile that was done again.
      if (issued[tile] >= std::min(merge.passes_wanted(tile) + (trial % 3 == 0 ? 5 : 0), kMostPasses))
        continue;
      merge.add(tile, issued[tile], pass_of(tile, issued[tile]));
      ++issued[tile];
      if (trial > 10 && random() % 100 == 0) {
        merge.redo(tile);
        issued[tile] = 0;
      }
    }
    EXPECT_EQ(merge.film().hash(), undisturbed.film().hash()) << trial;
  }
}

TEST(AdaptiveMerge, ASkippedPassStopsNothing) {
  Merge merge({0, 0, kSide, kSide, kNoLayers}, TileGrid(0, 0, kSide, kSide, kSide, 40 * kPerPass, kPerPass),
              {.target_error = 0.01});
  merge.skip(0, 0);
  for (std::uint32_t pass = 1; pass < merge.passes_wanted(0); ++pass) merge.add(0, pass, pass_of(3, pass));
  EXPECT_TRUE(merge.is_done());
  EXPECT_EQ(merge.finished_passes(), 40u);
  EXPECT_EQ(merge.film().at(0, 0).count, 39 * kPerPass);
}

TEST(AdaptiveMerge, ExpectsMoreWhereTheErrorIsLarge) {
  const auto expected = [](double target) {
    Merge merge({0, 0, kFilm, kFilm, kNoLayers}, grid(), {.target_error = target});
    for (std::uint32_t tile = 0; tile < grid().tiles(); ++tile)
      for (std::uint32_t pass = 0; pass < 4; ++pass) merge.add(tile, pass, pass_of(tile, pass));
    return double(merge.samples_expected());
  };
  EXPECT_NEAR(expected(0.1) / expected(0.2), 4, 1);
  EXPECT_EQ(expected(1e-6), double(grid().samples(kMostPasses)));
}

}  // namespace
}  // namespace penumbra
