// Samples are distributed among tiles by pilot paths: most go where the error is largest, the film is that of
// the other samples alone (pilot paths are discarded), and it does not depend on order, interruptions or
// skipped passes.
#include "scheduler/plan/sample_allocation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "scheduler/plan/merge.h"
#include "tests/support/fake_samples.h"

namespace penumbra::sample_allocation_test {
namespace {

constexpr int kSide = 16;  // of a tile

TileGrid grid(int across, int down, std::uint32_t spp, std::uint32_t samples_per_pass = 16) {
  return {3, 5, across * kSide, down * kSide, kSide, spp, samples_per_pass};
}

/// Two samples of each pixel: normal, of mean 1 and this deviation.
SampleBuffer noise(std::mt19937_64& random, double deviation, const RenderUnit& unit) {
  SampleBuffer result{
      .width = unit.width,
      .height = unit.height,
      .planes = kNoLayers.planes(),
      .sample_count = unit.sample_count,
      .values = std::vector<float>(std::size_t(unit.width) * unit.height * kNoLayers.planes())};
  std::normal_distribution<float> value(1, float(deviation));
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < result.pixels(); ++i) {
      const float a = value(random), b = value(random);
      result.plane(kMeanR + c)[i] = (a + b) / 2;
      result.plane(kDeviationR + c)[i] = std::abs(a - b) / 2;
    }
  return result;
}

SampleAllocation allocation(const TileGrid& grid, const std::vector<double>& deviations) {
  SampleAllocation made(grid);
  std::mt19937_64 random(7);
  for (std::uint32_t tile = 0; tile < grid.tiles(); ++tile) {
    EXPECT_FALSE(made.is_made());
    made.add_pilot(tile, noise(random, deviations[tile], made.unit(tile, 0)));
  }
  EXPECT_TRUE(made.is_made());
  return made;
}

std::uint64_t samples(const SampleAllocation& made, const TileGrid& grid) {
  std::uint64_t all = 0;
  for (std::uint32_t tile = 0; tile < grid.tiles(); ++tile) all += grid.pixels(tile) * made.spp(tile);
  return all;
}

TEST(SampleAllocation, FollowsTheVarianceToThePowerOfTwoFifths) {
  const TileGrid tiles = grid(16, 8, 64);
  std::vector<double> deviations(tiles.tiles());
  for (std::size_t i = 0; i < deviations.size(); ++i) deviations[i] = 0.02 * std::exp2(double(i % 16) / 4);
  const SampleAllocation made = allocation(tiles, deviations);
  const std::uint64_t budget = tiles.samples(tiles.passes());
  EXPECT_LE(samples(made, tiles), budget);
  EXPECT_GT(samples(made, tiles), budget - budget / 50) << "128 tiles leave little over";
  double sum = 0;
  for (const double deviation : deviations) sum += std::pow(deviation, 0.8);
  const double mean = sum / double(deviations.size());
  for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile) {
    EXPECT_EQ(std::popcount(made.spp(tile)), 1) << "a net of Sobol points";
    // Half an octave each way are powers of two; half of one more, how full the budget is and the pilot's
    // error, 1 / sqrt(2 * 3 * 256) = 2.6 % of a deviation.
    EXPECT_LE(std::abs(std::log2(made.spp(tile) / (64 * std::pow(deviations[tile], 0.8) / mean))), 1.1)
        << tile;
  }
}

TEST(SampleAllocation, TakesALessErrorThanEquallyManySamplesAndNearlyTheLeast) {
  const TileGrid tiles = grid(16, 16, 64);
  std::vector<double> deviations(tiles.tiles());
  std::mt19937_64 random(3);
  std::lognormal_distribution<double> any(-3, 1);
  for (double& deviation : deviations) deviation = any(random);
  const SampleAllocation made = allocation(tiles, deviations);
  double equal = 0, ours = 0, root = 0;
  for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile) {
    const double variance = deviations[tile] * deviations[tile];
    equal += variance / 64;
    ours += variance / made.spp(tile);
    root += deviations[tile];
  }
  const double least = root * root / double(tiles.tiles()) / 64;
  EXPECT_LT(ours, 0.6 * equal);
  // The power costs 1.04 if samples cost the same, and those of two as much.
  EXPECT_LT(ours, 1.12 * least);
}

TEST(SampleAllocation, EqualTilesGetWhatAllGet) {
  for (const std::uint32_t spp : {1u, 2u, 8u, 64u, 1024u}) {
    const TileGrid tiles = grid(3, 2, spp);
    SampleAllocation made(tiles);
    for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile) {
      std::mt19937_64 random(1);
      made.add_pilot(tile, noise(random, 0.3, made.unit(tile, 0)));
    }
    for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile) EXPECT_EQ(made.spp(tile), spp);
  }
}

TEST(SampleAllocation, TilesWithoutNoiseShareAlike) {
  const TileGrid tiles = grid(6, 4, 64);
  std::vector<double> deviations(tiles.tiles());
  for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile)
    EXPECT_EQ(allocation(tiles, deviations).spp(tile), 64u);
  deviations[20] = 1;
  const SampleAllocation made = allocation(tiles, deviations);
  EXPECT_EQ(made.spp(20), 16 * 64u);
  for (std::uint32_t tile = 0; tile < 20; ++tile) EXPECT_LE(made.spp(tile), 2 * made.spp(23)) << tile;
}

TEST(SampleAllocation, StaysWithinTheBudgetForAnyNumberOfSamples) {
  const TileGrid any = grid(5, 5, 1);
  std::vector<double> deviations(any.tiles());
  for (std::size_t i = 0; i < deviations.size(); ++i) deviations[i] = 0.1 * double(i);  // one without noise
  for (std::uint32_t spp = 1; spp < 100; ++spp) {
    const TileGrid tiles = grid(5, 5, spp);
    const SampleAllocation made = allocation(tiles, deviations);
    EXPECT_LE(samples(made, tiles), tiles.samples(tiles.passes())) << spp;
    EXPECT_GT(2 * samples(made, tiles), tiles.samples(tiles.passes())) << spp;
    for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile) {
      EXPECT_GE(made.spp(tile), std::max(1u, spp / 8));
      EXPECT_LE(made.spp(tile), 16 * spp);
      EXPECT_LE(made.passes(tile), made.most_passes());
    }
  }
}

TEST(SampleAllocation, UnitsAreThePilotAndThenEverySampleOnce) {
  const TileGrid tiles = grid(4, 4, 40, 16);
  std::vector<double> deviations(tiles.tiles(), 0.1);
  deviations[5] = 2;
  const SampleAllocation made = allocation(tiles, deviations);
  for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile) {
    EXPECT_EQ(made.unit(tile, 0).sequence, 1u);
    EXPECT_EQ(made.unit(tile, 0).sample_count, 2u);
    EXPECT_EQ(made.unit(tile, 0).spp, 2u);
    std::uint32_t next = 0;
    for (std::uint32_t pass = 1; pass < made.passes(tile); ++pass) {
      const RenderUnit unit = made.unit(tile, pass);
      EXPECT_EQ(unit.sequence, 0u);
      EXPECT_EQ(unit.spp, made.spp(tile));
      EXPECT_EQ(unit.first_sample, next);
      next += unit.sample_count;
      EXPECT_EQ(made.counted(tile, pass + 1), next);
      EXPECT_EQ(made.rendered(tile, pass + 1), next + 2);
    }
    EXPECT_EQ(next, made.spp(tile));
  }
  EXPECT_GT(made.spp(5), made.spp(4));
}

TEST(SampleAllocation, ATileWithoutAPilotCountsAsAMeanOne) {
  const TileGrid tiles = grid(4, 1, 64);
  SampleAllocation made(tiles);
  std::mt19937_64 random(1);
  made.skip_pilot(0);
  made.skip_pilot(1);
  for (const std::uint32_t tile : {2u, 3u}) made.add_pilot(tile, noise(random, 0.1, made.unit(tile, 0)));
  ASSERT_TRUE(made.is_made());
  for (std::uint32_t tile = 0; tile < 4; ++tile) EXPECT_EQ(made.spp(tile), 64u);
}

/// Made-up samples of a unit, other ones in each sequence, in tiles to the right more different ones.
SampleBuffer result_of(const RenderUnit& unit) {
  RenderUnit other = unit;
  other.first_sample += unit.sequence * 1000003u + unit.spp * 7919u;
  SampleBuffer result = fake_samples(other, kFeatureLayers);
  const float scale = float(unit.x * unit.x) / 1000;
  for (int c = 0; c < 3; ++c) {
    for (float& mean : result.plane(kMeanR + c)) mean = 1 + (mean - 0.5f) * scale;
    for (float& deviation : result.plane(kDeviationR + c)) deviation *= scale;
  }
  return result;
}

constexpr std::uint32_t kSpp = 40;
Merge empty_merge(const TileGrid& tiles) {
  return {FilmAccumulator(3, 5, 6 * kSide, 3 * kSide, kFeatureLayers), tiles, {.adaptive = true}};
}

Merge rendered(const TileGrid& tiles) {
  Merge merge = empty_merge(tiles);
  for (std::uint32_t pass = 0; pass < merge.most_passes(); ++pass)
    for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile)
      if (pass < merge.passes_wanted(tile)) merge.add(tile, pass, result_of(merge.unit(tile, pass)));
  EXPECT_TRUE(merge.is_done());
  return merge;
}

TEST(MergeOfAllocatedSamples, IsTheFilmOfTheSamplesThatCount) {
  const TileGrid tiles = grid(6, 3, kSpp);
  const Merge merge = rendered(tiles);
  FilmAccumulator film(3, 5, 6 * kSide, 3 * kSide, kFeatureLayers);
  std::uint64_t least = ~0ull, most = 0;
  for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile)
    for (std::uint32_t pass = SampleAllocation::kPilotPasses; pass < merge.passes_wanted(tile); ++pass) {
      const RenderUnit unit = merge.unit(tile, pass);
      film.add(unit.x, unit.y, result_of(unit));
      least = std::min(least, std::uint64_t(unit.spp));
      most = std::max(most, std::uint64_t(unit.spp));
    }
  EXPECT_EQ(merge.film().hash(), film.hash());
  EXPECT_LT(4 * least, most) << "or nothing was shared out";
  EXPECT_EQ(merge.samples_expected(), merge.samples());
  EXPECT_FALSE(merge.units_in_order());
  EXPECT_TRUE(merge.unit(0, merge.passes_wanted(0)).sample_count == 0);
}

TEST(MergeOfAllocatedSamples, ShowsThePilotUntilThereIsMore) {
  const TileGrid tiles = grid(6, 3, kSpp);
  Merge merge = empty_merge(tiles);
  EXPECT_EQ(merge.passes_at_first(), 1u);
  for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile) {
    EXPECT_FALSE(merge.take_allocation());
    EXPECT_EQ(merge.unit(tile, 1).sample_count, 0u) << "not known yet";
    merge.add(tile, 0, result_of(merge.unit(tile, 0)));
    EXPECT_EQ(merge.film().at(merge.unit(tile, 0).x, merge.unit(tile, 0).y).count, 2u);
  }
  EXPECT_TRUE(merge.take_allocation());
  EXPECT_FALSE(merge.take_allocation()) << "said once";
  const RenderUnit unit = merge.unit(4, 1);
  merge.add(4, 1, result_of(unit));
  EXPECT_EQ(merge.film().at(unit.x, unit.y).count, unit.sample_count);
}

TEST(MergeOfAllocatedSamples, ComesToTheSameFilmInAnyOrderAndFromAnyCheckpoint) {
  const TileGrid tiles = grid(6, 3, kSpp, 4);
  const std::uint64_t expected = rendered(tiles).film().hash();
  std::mt19937 random(5);
  for (int trial = 0; trial < 30; ++trial) {
    Merge merge = empty_merge(tiles);
    std::vector<std::uint32_t> issued(tiles.tiles());
    const std::uint64_t interruption = trial % 2 == 0 ? random() % 150 : ~0ull;
    for (std::uint64_t unit = 0; !merge.is_done(); ++unit) {
      if (unit == interruption) {
        std::vector<std::uint8_t> bytes;
        ByteWriter writer(bytes);
        merge.write(writer);
        Merge resumed = empty_merge(tiles);
        ByteReader reader(bytes);
        const auto read = resumed.read(reader);
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_EQ(reader.left(), 0u);
        merge = std::move(resumed);
        issued = merge.merged_passes();
      }
      const auto tile = std::uint32_t(random() % tiles.tiles());
      if (issued[tile] >= merge.passes_wanted(tile)) continue;
      merge.add(tile, issued[tile], result_of(merge.unit(tile, issued[tile])));
      ++issued[tile];
      if (trial > 15 && random() % 100 == 0) {
        merge.redo(tile);
        issued[tile] = 0;
      }
    }
    EXPECT_EQ(merge.film().hash(), expected) << trial;
    EXPECT_EQ(merge.waiting(), 0u);
  }
}

TEST(MergeOfAllocatedSamples, SkippedPassesStopNothing) {
  const TileGrid tiles = grid(6, 3, kSpp);
  Merge merge = empty_merge(tiles);
  const auto is_lost = [](std::uint32_t tile, std::uint32_t pass) {
    return (tile == 1 && pass == 0) || (tile == 2 && pass == 1);
  };
  for (std::uint32_t pass = 0; pass < merge.most_passes(); ++pass)
    for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile) {
      if (pass >= merge.passes_wanted(tile)) continue;
      if (is_lost(tile, pass))
        merge.skip(tile, pass);
      else
        merge.add(tile, pass, result_of(merge.unit(tile, pass)));
    }
  EXPECT_TRUE(merge.is_done());
  std::vector<std::uint8_t> bytes;
  ByteWriter writer(bytes);
  merge.write(writer);
  Merge resumed = empty_merge(tiles);
  ByteReader reader(bytes);
  ASSERT_TRUE(resumed.read(reader));
  EXPECT_EQ(resumed.merged_passes(), std::vector<std::uint32_t>(tiles.tiles())) << "shares will be others";
  EXPECT_FALSE(merge.is_undisturbed());
  for (std::uint32_t pass = 0; pass < resumed.most_passes(); ++pass)
    for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile)
      if (pass < resumed.passes_wanted(tile)) resumed.add(tile, pass, result_of(resumed.unit(tile, pass)));
  EXPECT_EQ(resumed.film().hash(), rendered(tiles).film().hash());
  EXPECT_TRUE(resumed.is_undisturbed());
  EXPECT_TRUE(resumed.is_done());
}

TEST(MergeOfAllocatedSamples, APilotThatIsAnotherWhenDoneAgainIsNoted) {
  const TileGrid tiles = grid(6, 3, kSpp);
  Merge merge = rendered(tiles);
  merge.redo(3);
  merge.add(3, 0, result_of(merge.unit(3, 0)));
  EXPECT_TRUE(merge.is_undisturbed());
  merge.redo(3);
  RenderUnit other = merge.unit(3, 0);
  other.sequence = 77;
  merge.add(3, 0, result_of(other));
  EXPECT_FALSE(merge.is_undisturbed());
}

TEST(MergeOfAllocatedSamples, ACheckpointThatCannotBeIsRefused) {
  const TileGrid tiles = grid(6, 3, kSpp);
  std::vector<std::uint8_t> bytes;
  ByteWriter writer(bytes);
  rendered(tiles).write(writer);
  const auto refused = [&](std::size_t from_end, std::uint8_t value) {
    std::vector<std::uint8_t> other = bytes;
    other[other.size() - from_end] = value;
    Merge merge = empty_merge(tiles);
    ByteReader reader(other);
    return !merge.read(reader);
  };
  EXPECT_FALSE(refused(1, 0)) << "as it was";
  EXPECT_TRUE(refused(1, 1)) << "more samples than there may be";
  EXPECT_TRUE(refused(8, 0)) << "none, or others than the film has";
  EXPECT_TRUE(refused(9, 0xff)) << "a variance that is none";
}

}  // namespace
}  // namespace penumbra::sample_allocation_test
