#include "scheduler/plan/merge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/support/fake_samples.h"

namespace penumbra::merge_test {
namespace {

constexpr int kX = 3, kY = 5, kWidth = 50, kHeight = 30;
constexpr std::uint32_t kSpp = 22, kSamplesPerPass = 4;

struct Piece {
  std::uint32_t tile, pass;
};

TileGrid grid(int tile) { return {kX, kY, kWidth, kHeight, tile, kSpp, kSamplesPerPass}; }

std::vector<Piece> pieces(const TileGrid& grid) {
  std::vector<Piece> all;
  for (std::uint32_t pass = 0; pass < grid.passes(); ++pass) {
    for (std::uint32_t tile = 0; tile < grid.tiles(); ++tile) all.push_back({tile, pass});
  }
  return all;
}

Merge empty_merge(const TileGrid& grid) {
  return {FilmAccumulator(kX, kY, kWidth, kHeight, kFeatureLayers), grid};
}

std::uint64_t merged_hash(int tile, unsigned order_seed) {
  const TileGrid tiles = grid(tile);
  std::vector<Piece> order = pieces(tiles);
  if (order_seed != 0) std::ranges::shuffle(order, std::mt19937(order_seed));
  Merge merge = empty_merge(tiles);
  for (const Piece& piece : order) {
    merge.add(piece.tile, piece.pass, fake_samples(tiles.unit(piece.tile, piece.pass), kFeatureLayers));
  }
  EXPECT_EQ(merge.finished_passes(), tiles.passes());
  EXPECT_EQ(merge.waiting(), 0u);
  return merge.film().hash();
}

TEST(Merge, TheFilmDependsNeitherOnTilesNorOnTheOrderOfArrival) {
  const std::uint64_t expected = merged_hash(64, 0);
  for (const int tile : {1, 7, 16, 61}) {
    for (const unsigned seed : {0u, 1u, 2u, 3u}) {
      EXPECT_EQ(merged_hash(tile, seed), expected) << "tile " << tile << ", order " << seed;
    }
  }
}

TEST(Merge, StartsAgainInTheSameMemory) {
  const TileGrid tiles = grid(16);
  Merge merge = empty_merge(tiles);
  const PixelStatistics* memory = &merge.film().at(kX, kY);
  merge.skip(1, 0);
  for (std::uint32_t tile = 0; tile < tiles.tiles(); ++tile) {
    for (const std::uint32_t pass : {0u, 1u, 4u})  // the last one waits
      if (tile != 1 || pass > 0)
        merge.add(tile, pass, fake_samples(tiles.unit(tile, pass), kFeatureLayers, 7));
  }
  ASSERT_GT(merge.waiting(), 0u);
  ASSERT_GT(merge.film().flagged()[BAD_NAN].count, 0u);
  merge.start_again();
  EXPECT_EQ(merge.waiting(), 0u);
  EXPECT_EQ(merge.finished_passes(), 0u);
  EXPECT_EQ(merge.film().flagged()[BAD_NAN].count, 0u);
  EXPECT_EQ(merge.film().hash(), empty_merge(tiles).film().hash());
  EXPECT_EQ(&merge.film().at(kX, kY), memory);
  for (const Piece& piece : pieces(tiles))
    merge.add(piece.tile, piece.pass, fake_samples(tiles.unit(piece.tile, piece.pass), kFeatureLayers));
  EXPECT_EQ(merge.film().hash(), merged_hash(16, 0));
}

TEST(Merge, TheHashNoticesAnOrderThatIsNotThePasses) {
  // The floor under the test above: without Merge the order of the passes does show in the bytes.
  const TileGrid tiles = grid(64);
  FilmAccumulator forwards(kX, kY, kWidth, kHeight, kFeatureLayers), backwards = forwards;
  for (std::uint32_t pass = 0; pass < tiles.passes(); ++pass) {
    forwards.add(kX, kY, fake_samples(tiles.unit(0, pass), kFeatureLayers));
    backwards.add(kX, kY, fake_samples(tiles.unit(0, tiles.passes() - 1 - pass), kFeatureLayers));
  }
  EXPECT_EQ(forwards.hash(), merged_hash(64, 0));
  EXPECT_NE(forwards.hash(), backwards.hash());
}

TEST(Merge, FinishedPassesAreThoseOfTheSlowestTile) {
  const TileGrid tiles = grid(25);  // 2 x 2 tiles
  Merge merge = empty_merge(tiles);
  const auto add = [&](std::uint32_t tile, std::uint32_t pass) {
    merge.add(tile, pass, fake_samples(tiles.unit(tile, pass), kFeatureLayers));
  };
  for (const std::uint32_t tile : {0, 1, 2}) add(tile, 0);
  EXPECT_EQ(merge.finished_passes(), 0u);
  add(3, 1);
  EXPECT_EQ(merge.finished_passes(), 0u);
  EXPECT_EQ(merge.waiting(), 1u);
  EXPECT_EQ(merge.film().at(kX + 30, kY + 26).count, 0u) << "pass 1 waits for pass 0";
  add(3, 0);
  EXPECT_EQ(merge.finished_passes(), 1u);
  EXPECT_EQ(merge.film().at(kX + 30, kY + 26).count, 2 * kSamplesPerPass);
}

TEST(Merge, SaysHowManyUnitsThereAreIfTheyAreTheFirstOnes) {
  const TileGrid tiles = grid(16);
  Merge merge = empty_merge(tiles);
  const std::uint32_t count = tiles.tiles();
  EXPECT_EQ(merge.units_in_order(), 0u);
  const auto add = [&](std::uint32_t tile, std::uint32_t pass) {
    merge.add(tile, pass, fake_samples(tiles.unit(tile, pass), kFeatureLayers));
  };
  for (std::uint32_t unit = 0; unit < 2 * count + 1; ++unit) {
    add(unit % count, unit / count);
    EXPECT_EQ(merge.units_in_order(), unit + 1);
  }
  add(2, 2);
  EXPECT_EQ(merge.units_in_order(), std::nullopt) << "tile 1 is missing";
  add(1, 2);
  EXPECT_EQ(merge.units_in_order(), 2 * count + 3);
  add(0, 3);
  EXPECT_EQ(merge.units_in_order(), std::nullopt) << "a pass of tile 3 is missing";
  merge.redo(0);
  add(0, 1);
  EXPECT_EQ(merge.units_in_order(), std::nullopt) << "it waits for the first";
  merge.skip(0, 0);
  EXPECT_EQ(merge.units_in_order(), std::nullopt) << "one is skipped";
}

TEST(Merge, ASkippedUnitDoesNotHoldUpItsTile) {
  const TileGrid tiles = grid(25);
  Merge merge = empty_merge(tiles);
  for (const Piece& piece : pieces(tiles)) {
    if (piece.tile == 1 && piece.pass == 2) continue;
    merge.add(piece.tile, piece.pass, fake_samples(tiles.unit(piece.tile, piece.pass), kFeatureLayers));
  }
  EXPECT_EQ(merge.finished_passes(), 2u);
  merge.skip(1, 2);
  EXPECT_EQ(merge.finished_passes(), tiles.passes());
  EXPECT_EQ(merge.film().at(kX, kY).count, kSpp);
  EXPECT_EQ(merge.film().at(kX + 25, kY).count, kSpp - kSamplesPerPass);
}

TEST(Merge, ARedoneTileLeavesNoTrace) {
  const TileGrid tiles = grid(25);
  Merge merge = empty_merge(tiles);
  const auto wrong = [&](std::uint32_t tile, std::uint32_t pass) {
    SampleBuffer buffer = fake_samples(tiles.unit(tile, pass), kFeatureLayers);
    buffer.values[0] += 1;
    buffer.flagged[BAD_NAN].count = 5;
    return buffer;
  };
  merge.add(2, 0, wrong(2, 0));
  merge.add(2, 3, wrong(2, 3));  // waits
  const RenderUnit area = tiles.unit(2, 0);
  EXPECT_EQ(merge.redo(2), std::uint64_t(area.width) * area.height * 2 * kSamplesPerPass);
  EXPECT_EQ(merge.waiting(), 0u);
  EXPECT_EQ(merge.film().flagged()[BAD_NAN].count, 0u);
  for (const Piece& piece : pieces(tiles)) {
    merge.add(piece.tile, piece.pass, fake_samples(tiles.unit(piece.tile, piece.pass), kFeatureLayers));
  }
  EXPECT_EQ(merge.film().hash(), merged_hash(64, 0));
}

TEST(Merge, ARedoRemembersWhatWasSkipped) {
  const TileGrid tiles(0, 0, 1, 1, 1, 3, 1);
  Merge merge(FilmAccumulator(0, 0, 1, 1, kNoLayers), tiles);
  merge.skip(0, 0);
  merge.add(0, 1, fake_samples(tiles.unit(0, 1), kNoLayers));
  merge.skip(0, 2);
  EXPECT_EQ(merge.finished_passes(), 3u);
  EXPECT_EQ(merge.redo(0), 1u);
  EXPECT_EQ(merge.finished_passes(), 1u);
  merge.add(0, 1, fake_samples(tiles.unit(0, 1), kNoLayers));
  EXPECT_EQ(merge.finished_passes(), 3u);
}

}  // namespace
}  // namespace penumbra::merge_test
