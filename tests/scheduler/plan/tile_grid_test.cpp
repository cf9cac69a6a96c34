#include "scheduler/plan/tile_grid.h"

#include <gtest/gtest.h>

#include <map>

namespace penumbra {
namespace {

class TileGridTest : public testing::TestWithParam<int> {};

TEST_P(TileGridTest, EverySampleOfEveryPixelIsInExactlyOneUnit) {
  const TileGrid grid(5, 7, 70, 33, GetParam(), 10, 4);
  EXPECT_EQ(grid.passes(), 3u);
  std::map<std::pair<int, int>, std::uint32_t> samples;  // so far, by pixel
  for (std::uint32_t pass = 0; pass < grid.passes(); ++pass) {
    for (std::uint32_t tile = 0; tile < grid.tiles(); ++tile) {
      const RenderUnit unit = grid.unit(tile, pass);
      ASSERT_GE(unit.sample_count, 1u);
      for (int y = unit.y; y < unit.y + unit.height; ++y) {
        for (int x = unit.x; x < unit.x + unit.width; ++x) {
          std::uint32_t& count = samples[{x, y}];
          ASSERT_EQ(count, unit.first_sample);
          count += unit.sample_count;
        }
      }
    }
  }
  EXPECT_EQ(samples.size(), 70u * 33u);
  EXPECT_EQ(samples.begin()->first, std::pair(5, 7));
  EXPECT_EQ(samples.rbegin()->first, std::pair(74, 39));
  for (const auto& [pixel, count] : samples) ASSERT_EQ(count, 10u);
}

INSTANTIATE_TEST_SUITE_P(Sizes, TileGridTest, testing::Values(1, 7, 16, 33, 61, 64, 70, 200));

TEST(TileGrid, CountsSamples) {
  const TileGrid grid(0, 0, 100, 10, 64, 10, 4);
  EXPECT_EQ(grid.samples(0), 0u);
  EXPECT_EQ(grid.samples(1), 4000u);
  EXPECT_EQ(grid.samples(3), 10000u);
}

TEST(TileGrid, HoldsTheLargestJobs) {
  const TileGrid grid(0, 0, 32768, 32768, 16, 0xffffffffu, 4096);
  EXPECT_EQ(grid.tiles(), 2048u * 2048u);
  EXPECT_EQ(grid.passes(), 1u << 20);
  const RenderUnit last = grid.unit(grid.tiles() - 1, grid.passes() - 1);
  EXPECT_EQ(last.x, 32752);
  EXPECT_EQ(last.first_sample + (last.sample_count - 1), 0xfffffffeu);
}

}  // namespace
}  // namespace penumbra
