#include "gl/tile_outlines.h"

#include <gtest/gtest.h>

#include <limits>

namespace penumbra {
namespace {

TEST(Letterbox, TheFilmFillsOneDirectionAndIsInTheMiddleOfTheOther) {
  EXPECT_EQ(letterboxed({0, 0, 900, 600}, 600, 400), (PixelRectangle{0, 0, 900, 600}));
  EXPECT_EQ(letterboxed({0, 0, 1000, 600}, 600, 400), (PixelRectangle{50, 0, 900, 600}));
  EXPECT_EQ(letterboxed({10, 20, 900, 700}, 600, 400), (PixelRectangle{10, 70, 900, 600}));
  EXPECT_EQ(letterboxed({0, 0, 30, 30}, 3000, 1), (PixelRectangle{0, 14, 30, 1}))
      << "never less than a pixel";
  EXPECT_EQ(letterboxed({0, 0, 0, 30}, 600, 400), PixelRectangle{});
  EXPECT_EQ(letterboxed({0, 0, 30, 30}, 0, 400), PixelRectangle{});
}

double area_of(const std::vector<OutlineVertex>& vertices) {
  double area = 0;
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3) {
    const auto &a = vertices[i], &b = vertices[i + 1], &c = vertices[i + 2];
    area += 0.5 * std::abs(double((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)));
  }
  return area;
}

WorkerView worker_at(int x, int y, int width, int height) {
  WorkerView worker;
  worker.x = x;
  worker.y = y;
  worker.width = width;
  worker.height = height;
  return worker;
}

TEST(TileOutlines, CoverTheInsideOfTheEdge) {
  const std::vector<WorkerView> one{worker_at(10, 10, 20, 10)};
  // A frame of 2 and one of 1 pixel within 40 × 20 pixels.
  const double expected = 40 * 20 - 34 * 14;
  EXPECT_DOUBLE_EQ(area_of(outline_triangles(one, {5, 5, 200, 100}, 100, 50, 2)), expected);
}

TEST(TileOutlines, SmallTilesAreFilledAndTinyOnesSeen) {
  const std::vector<WorkerView> one{worker_at(10, 10, 3, 3)};
  EXPECT_DOUBLE_EQ(area_of(outline_triangles(one, {0, 0, 100, 100}, 100, 100, 2)), 9);
  EXPECT_DOUBLE_EQ(area_of(outline_triangles(one, {0, 0, 10, 10}, 100, 100, 2)), 1);
}

TEST(TileOutlines, WorkersWithoutATileOfThisFilmAreLeftOut) {
  constexpr int kMost = std::numeric_limits<int>::max();
  const std::vector<WorkerView> none{worker_at(0, 0, 0, 5),         worker_at(0, 0, 5, 0),
                                     worker_at(-1, 0, 5, 5),        worker_at(96, 0, 5, 5),
                                     worker_at(0, 0, kMost, kMost), worker_at(kMost, 0, 1, 1)};
  EXPECT_TRUE(outline_triangles(none, {0, 0, 100, 100}, 100, 100, 2).empty());
  EXPECT_TRUE(outline_triangles({}, {0, 0, 100, 100}, 0, 0, 2).empty());
}

TEST(WorkerColors, NeighboursAreFarApartAndAllAreBright) {
  for (std::uint32_t i = 0; i < 64; ++i) {
    const auto color = worker_color(i);
    float most = 0;
    for (const float channel : color) {
      EXPECT_GE(channel, 0.34f);
      EXPECT_LE(channel, 1.0f);
      most = std::max(most, channel);
    }
    EXPECT_EQ(most, 1.0f);
    for (std::uint32_t j = i + 1; j < i + 5; ++j) {
      float distance = 0;
      for (std::size_t c = 0; c < 3; ++c) distance += std::abs(color[c] - worker_color(j)[c]);
      EXPECT_GT(distance, 0.3f) << i << " and " << j;
    }
  }
}

}  // namespace
}  // namespace penumbra
