// Tests what a tile's snapshot contains, and when tiles are shown.
#include "scheduler/watch/render_feed.h"
#include "tests/support/film_layers.h"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

namespace penumbra::render_feed_test {
namespace {

using namespace std::chrono_literals;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kX = 5, kY = 3, kWidth = 7, kHeight = 6;
constexpr RenderUnit kArea{.x = 6, .y = 5, .width = 4, .height = 3, .first_sample = 0, .sample_count = 0};

/// A value for each pixel, plane and pass, some of them negative.
float value(int x, int y, int plane, int pass) {
  return 0.37f * float(x) - 0.21f * float(y) + 0.11f * float(plane) - 0.05f * float(pass * pass);
}

SampleBuffer made_up(int pass, std::uint32_t samples) {
  SampleBuffer buffer{.width = kWidth,
                      .height = kHeight,
                      .planes = kPolygonLayers.planes(),
                      .sample_count = samples,
                      .values = std::vector<float>(std::size_t(kWidth * kHeight * kPolygonLayers.planes()))};
  for (int plane = 0; plane < kPolygonLayers.planes(); ++plane)
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        float& v = buffer.plane(plane)[std::size_t(y * kWidth + x)];
        v = value(kX + x, kY + y, plane, pass);
        const bool is_deviation = plane >= kDeviationR && plane <= kDeviationB;
        if (is_deviation) v = samples < 2 ? 0.0f : std::fabs(v);
        // Means of these are too small for a float: negative zeros.
        const int difference = kPolygonLayers.plane(LAYER_DIFFERENCE);
        if (plane >= difference && plane < difference + 3 && (x + y) % 3 == 0)
          v = pass == 0 ? 0.0f : -std::numeric_limits<float>::denorm_min();
      }
  return buffer;
}

FilmAccumulator film_of(const std::vector<std::uint32_t>& passes) {
  FilmAccumulator film(kX, kY, kWidth, kHeight, kPolygonLayers);
  for (std::size_t pass = 0; pass < passes.size(); ++pass) film.add(kX, kY, made_up(int(pass), passes[pass]));
  return film;
}

template <typename Visit>
void for_each_pixel(Visit visit) {
  std::size_t i = 0;
  for (int y = kArea.y; y < kArea.y + kArea.height; ++y)
    for (int x = kArea.x; x < kArea.x + kArea.width; ++x) visit(x, y, i++);
}

TEST(Snapshot, TakesTheMemoryThatIsCountedForIt) {
  for (const bool hybrid : {true, false}) {
    const TileSnapshot tile = snapshot_of(film_of({2}), kArea, hybrid, 1);
    const std::size_t floats = tile.radiance.size() + tile.difference.size() + tile.standard_error.size();
    EXPECT_EQ(floats * sizeof(float), tile.pixels() * TileSnapshot::bytes_per_pixel(hybrid));
  }
}

std::uint32_t bits(float v) { return std::bit_cast<std::uint32_t>(v); }

TEST(SnapshotOf, HoldsTheFilmsMeansPixelByPixel) {
  const FilmAccumulator film = film_of({4, 3});
  const TileSnapshot tile = snapshot_of(film, kArea, false, 1);
  EXPECT_EQ(tile.x, kArea.x);
  EXPECT_EQ(tile.y, kArea.y);
  EXPECT_EQ(tile.width, kArea.width);
  EXPECT_EQ(tile.height, kArea.height);
  EXPECT_EQ(tile.samples, 7u);
  EXPECT_THAT(tile.difference, IsEmpty());
  ASSERT_THAT(tile.radiance, SizeIs(3 * tile.pixels()));
  for_each_pixel([&](int x, int y, std::size_t i) {
    for (int c = 0; c < 3; ++c) {
      // By hand: 4 samples of one mean and 3 of another. Two roundings of doubles stay far below a float's.
      const double expected = (4.0 * value(x, y, kMeanR + c, 0) + 3.0 * value(x, y, kMeanR + c, 1)) / 7;
      EXPECT_NEAR(tile.radiance[3 * i + std::size_t(c)], expected, 6e-8 * std::fabs(expected) + 1e-12);
    }
  });
}

TEST(SnapshotOf, TheDifferenceForAlphaOneIsTheFilmsLayerToTheBit) {
  const FilmAccumulator film = film_of({2, 1});
  const TileSnapshot tile = snapshot_of(film, kArea, true, 1);
  ASSERT_THAT(tile.difference, SizeIs(3 * tile.pixels()));
  int negative_zeros = 0;
  for_each_pixel([&](int x, int y, std::size_t i) {
    for (int c = 0; c < 3; ++c) {
      const float shown = tile.difference[3 * i + std::size_t(c)];
      EXPECT_EQ(bits(shown), bits(float(film.layer(x, y, LAYER_DIFFERENCE, c))));
      if (bits(shown) == bits(-0.0f)) ++negative_zeros;
    }
  });
  EXPECT_GT(negative_zeros, 0) << "the case that a sum in float would change";
}

TEST(SnapshotOf, TheDifferenceForOtherAlphasAddsTheRestOfTheClosedForm) {
  const FilmAccumulator film = film_of({2, 1});
  for (const float alpha : {0.0f, 0.25f, 0.9f, 1.7f, -3.0f}) {
    const TileSnapshot tile = snapshot_of(film, kArea, true, alpha);
    for_each_pixel([&](int x, int y, std::size_t i) {
      for (int c = 0; c < 3; ++c) {
        const long double analytic = film.layer(x, y, LAYER_ANALYTIC, c);
        const long double difference = film.layer(x, y, LAYER_DIFFERENCE, c);
        // difference + analytic is the image's light; what is left of it without alpha parts of the form.
        const long double expected = difference + analytic - (long double)(alpha)*analytic;
        const double size = double(std::fabs(difference) + std::fabs(analytic) * (1 + std::fabs(alpha)));
        EXPECT_NEAR(tile.difference[3 * i + std::size_t(c)], double(expected),
                    6e-8 * std::fabs(double(expected)) + 1e-15 * size);
      }
    });
  }
}

TEST(SnapshotOf, HoldsTheLayersThatViewersWant) {
  const FilmAccumulator film = film_of({2, 1});
  const std::vector<std::string> names = watchable_layers(film.layers());
  EXPECT_THAT(names, testing::IsSupersetOf({"albedo", "normal", "depth"}));
  EXPECT_THAT(names, testing::Not(testing::Contains("difference")));
  EXPECT_THAT(snapshot_of(film, kArea, true, 1).layers, IsEmpty());
  const TileSnapshot tile = snapshot_of(film, kArea, true, 1, {"depth", "albedo", "difference", "nonsense"});
  ASSERT_THAT(tile.layers, SizeIs(2));
  EXPECT_EQ(tile.layers[0].name, "albedo");
  EXPECT_EQ(tile.layers[1].name, "depth");
  for_each_pixel([&](int x, int y, std::size_t i) {
    EXPECT_EQ(bits(tile.layers[1].values[i]), bits(float(film.layer(x, y, LAYER_DEPTH))));
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_EQ(bits(tile.layers[0].values[3 * i + c]), bits(float(film.layer(x, y, LAYER_ALBEDO, int(c)))));
  });
}

TEST(SnapshotOf, TheStandardErrorIsThatOfAllSamplesTogether) {
  const std::vector<std::uint32_t> passes{4, 1, 7};
  const TileSnapshot tile = snapshot_of(film_of(passes), kArea, false, 1);
  for_each_pixel([&](int x, int y, std::size_t i) {
    // Var(mean) of each channel from the sums of squares about 0, in long double; then the mean over
    // channels.
    long double sum_of_variances = 0;
    const long double n = 12;
    for (int c = 0; c < 3; ++c) {
      long double sum = 0, squares = 0;
      for (int pass = 0; pass < int(passes.size()); ++pass) {
        const long double m = value(x, y, kMeanR + c, pass), k = passes[std::size_t(pass)];
        const long double d = k < 2 ? 0.0f : value(x, y, kDeviationR + c, pass);
        sum += k * m;
        squares += k * (m * m + d * d);
      }
      sum_of_variances += (squares - sum * sum / n) / (n * (n - 1));
    }
    const double expected = double(std::sqrt(sum_of_variances / 3));
    // A float's rounding, and that of some sums in double.
    EXPECT_NEAR(tile.standard_error[i], expected, 6.1e-8 * expected);
  });
}

TEST(SnapshotOf, TheStandardErrorIsUnknownBelowTwoSamples) {
  for (const float v : snapshot_of(film_of({1}), kArea, false, 1).standard_error) EXPECT_TRUE(std::isnan(v));
  for (const float v : snapshot_of(film_of({1, 1}), kArea, false, 1).standard_error)
    EXPECT_TRUE(std::isfinite(v) && v > 0);
  const TileSnapshot nothing = snapshot_of(film_of({}), kArea, true, 0.5f);
  EXPECT_EQ(nothing.samples, 0u);
  for (const float v : nothing.standard_error) EXPECT_TRUE(std::isnan(v));
  for (const float v : nothing.radiance) EXPECT_EQ(v, 0);
}

// --- The feed

/// Tiles of one pixel each.
struct Feed {
  explicit Feed(int tiles) : grid(0, 0, tiles, 1, 1, 100, 1), board(grid.tiles()), feed(board, grid, false) {
    film = FilmAccumulator(0, 0, tiles, 1, kNoLayers);
  }
  void merge(std::uint32_t tile, WorkerId worker = 1) {
    film.add(int(tile), 0,
             {.width = 1,
              .height = 1,
              .planes = kNoLayers.planes(),
              .sample_count = 1,
              .values = std::vector<float>(kRadiancePlanes)});
    feed.tile_changed(tile, worker);
  }
  std::vector<TileSnapshot> shown(WatchBoard::Watcher& watcher) {
    std::vector<TileSnapshot> tiles;
    while (const auto item = watcher.next(0ms))
      if (const auto* tile = std::get_if<std::shared_ptr<const TileSnapshot>>(&*item))
        tiles.push_back(**tile);
    return tiles;
  }
  TileGrid grid;
  WatchBoard board;
  RenderFeed feed;
  FilmAccumulator film;
};

TEST(RenderFeed, ShowsChangedTilesAFewAtATimeOrAll) {
  Feed f(100);
  WatchBoard::Watcher watcher(f.board);
  f.feed.begin_view({4, {}});
  for (std::uint32_t tile = 0; tile < 100; ++tile) f.merge(tile, tile + 7);
  f.feed.publish(f.film, false);
  const std::size_t some = f.shown(watcher).size();
  EXPECT_GT(some, 0u);
  EXPECT_LT(some, 100u) << "the render's thread has other things to do";
  f.feed.publish(f.film, true);
  const std::vector<TileSnapshot> rest = f.shown(watcher);
  EXPECT_EQ(some + rest.size(), 100u) << "each once";
  for (const TileSnapshot& tile : rest) {
    EXPECT_EQ(tile.view, 4u);
    EXPECT_EQ(tile.worker, std::uint32_t(tile.x) + 7);
    EXPECT_EQ(tile.samples, 1u);
  }
  f.feed.publish(f.film, true);
  EXPECT_THAT(f.shown(watcher), IsEmpty());
}

TEST(RenderFeed, WhoComesLateGetsAllTilesThatHaveSamples) {
  Feed f(10);
  for (std::uint32_t tile = 0; tile < 6; ++tile) f.merge(tile);
  f.feed.publish(f.film, true);  // no watchers
  WatchBoard::Watcher watcher(f.board);
  f.feed.publish(f.film, true);
  EXPECT_THAT(f.shown(watcher), SizeIs(6));
}

TEST(RenderFeed, ATileWhoseFirstPassIsMissingIsNotShown) {
  Feed f(2);
  WatchBoard::Watcher watcher(f.board);
  f.feed.tile_changed(0, 1);  // a later pass has come, which waits
  f.feed.publish(f.film, true);
  EXPECT_THAT(f.shown(watcher), IsEmpty());
  f.merge(0);
  f.feed.publish(f.film, true);
  EXPECT_THAT(f.shown(watcher), SizeIs(1));
}

TEST(RenderFeed, AnotherViewForgetsWhatHasChanged) {
  Feed f(10);
  WatchBoard::Watcher watcher(f.board);
  f.feed.publish(f.film, true);  // answers the request for all tiles, of which there are none
  f.merge(3);
  f.feed.begin_view({1, {}});
  f.feed.publish(f.film, true);
  EXPECT_THAT(f.shown(watcher), IsEmpty());
}

}  // namespace
}  // namespace penumbra::render_feed_test
