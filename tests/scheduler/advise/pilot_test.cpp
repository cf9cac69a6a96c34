// Pilot renders: where they are, and what they count.
#include "scheduler/advise/pilot.h"

#include <gtest/gtest.h>

#include <set>

#include "scenes/device/device_scene_builder.h"
#include "scenes/scene_reader.h"
#include "scheduler/advise/work.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

Film film_of(int width, int height) {
  Film film;
  film.width = film.crop_width = width;
  film.height = film.crop_height = height;
  return film;
}

TEST(PilotTiles, AreDistinctAndInTheCropWindow) {
  for (const auto& [width, height] :
       {std::pair(24, 20), {640, 360}, {3, 2000}, {4096, 4096}, {64, 64}, {1, 1}}) {
    Film film = film_of(width + 7, height + 5);
    film.crop_x = 7;
    film.crop_y = 5;
    film.crop_width = width;
    film.crop_height = height;
    const auto tiles = pilot_tiles(film);
    ASSERT_FALSE(tiles.empty());
    EXPECT_LE(tiles.size(), std::size_t(kPilotTiles)) << width << " x " << height;
    std::set<std::pair<int, int>> places;
    for (const PilotTile& tile : tiles) {
      EXPECT_TRUE(places.emplace(tile.x, tile.y).second);
      EXPECT_GE(tile.x, 7);
      EXPECT_GE(tile.y, 5);
      EXPECT_LE(tile.x + tile.width, 7 + width);
      EXPECT_LE(tile.y + tile.height, 5 + height);
      EXPECT_GE(tile.width, 1);
      EXPECT_GE(tile.height, 1);
    }
  }
}

TEST(PilotTiles, AreAtMostAsMany) {
  for (const int most : {16, 17, 40}) {
    const std::size_t tiles = pilot_tiles(film_of(640, 360), most).size();
    EXPECT_LE(tiles, std::size_t(most));
    EXPECT_GT(tiles, std::size_t(most) * 3 / 4);
  }
}

TEST(PilotTiles, CoverASmallWindow) {
  int pixels = 0;
  for (const PilotTile& tile : pilot_tiles(film_of(24, 20))) pixels += tile.width * tile.height;
  EXPECT_EQ(pixels, 24 * 20);
}

class PilotOfSmallScene : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }
  /// Of the scene, with these settings.
  Pilot pilot(std::vector<std::pair<std::string, std::string>> settings, int threads = 2) {
    ReadOptions read;
    read.settings = std::move(settings);
    const auto description = read_scene((folder_ / "s.xml").string(), read);
    EXPECT_TRUE(description) << description.error().message;
    auto scene = build_device_scene(*description, {});
    EXPECT_TRUE(scene);
    const auto rendered = render_pilot(*scene, pilot_tiles(description->film), threads);
    EXPECT_TRUE(rendered);
    return *rendered;
  }
  TemporaryFolder folder_;
};

TEST_F(PilotOfSmallScene, CountsItsRays) {
  // Emitters seen directly take a ray a sample, and nothing else.
  const Pilot seen = pilot({{"integrator.max_depth", "1"}});
  EXPECT_EQ(seen.samples, 24u * 20 * kPilotSamples * kPilotBatches);
  EXPECT_EQ(seen.traced.rays, seen.samples);
  EXPECT_EQ(seen.traced.shadow_rays, 0u);
  EXPECT_EQ(seen.traced.photon_rays, 0u);
  // Direct light takes at most one shadow ray, and one more ray.
  const Pilot lit = pilot({{"integrator.max_depth", "2"}});
  EXPECT_GT(lit.traced.rays, lit.samples);
  EXPECT_LE(lit.traced.rays, 2 * lit.samples);
  EXPECT_GT(lit.traced.shadow_rays, 0u);
  EXPECT_LE(lit.traced.shadow_rays, lit.samples);
  // A photon path has at least one ray.
  const Pilot photons = pilot({{"integrator.type", "ppm"}, {"integrator.photon_count", "1000"}});
  EXPECT_GE(photons.traced.photon_rays, 1000u);
}

TEST_F(PilotOfSmallScene, DoesNotDependOnThreads) {
  const Pilot one = pilot({}, 1), three = pilot({}, 3);
  EXPECT_EQ(one.means, three.means);
  EXPECT_EQ(one.within, three.within);
  EXPECT_EQ(one.traced.rays, three.traced.rays);
  EXPECT_EQ(one.traced.shadow_rays, three.traced.shadow_rays);
}

TEST_F(PilotOfSmallScene, HasIndependentBatches) {
  const Pilot rendered = pilot({});
  for (int b = 1; b < kPilotBatches; ++b) EXPECT_NE(rendered.means[0], rendered.means[std::size_t(b)]);
}

}  // namespace
}  // namespace penumbra
