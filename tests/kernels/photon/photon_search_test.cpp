// Searches of photon maps against brute force.
#include "kernels/photon/photon_search.h"

#include <gtest/gtest.h>

#include <climits>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "kernels/host/photon_map_builder.h"

namespace penumbra {
namespace {

struct Maps {
  SceneHeader header{};
  PhotonTask task{};
  std::vector<Photon> photons;
  AlignedVector<std::uint32_t> words;

  void build() { words = build_photon_maps(header, task, photons); }
  [[nodiscard]] PhotonTable table() const { return photon_table(words.data(), PHOTON_MAP_SURFACE); }
};

/// `count` photons on a floor and a wall, seen from either side, within `extent` of the origin.
Maps random_maps(int count, float radius, float extent) {
  Maps maps;
  IntegratorParameters& p = maps.header.integrator;
  p.photons = PHOTONS_FIXED;
  p.surface_photons = 1000;
  p.surface_radius = p.caustic_radius = p.volume_radius = radius;
  p.radius_alpha = 1;
  p.emission_radius = 2 * extent;
  maps.task = {.map = 0, .sequence = 0, .paths = 1000};
  std::mt19937 engine(count + int(1000 * radius));
  std::uniform_real_distribution<float> within(-extent, extent);
  for (int i = 0; i < count; ++i) {
    Photon photon{};
    const bool floor = i % 3 != 0;
    photon.p = {within(engine), within(engine), within(engine)};
    (floor ? photon.p.z : photon.p.x) = 0;
    photon.normal = floor ? make_vec3(0, 0, i % 2 != 0 ? 1.0f : -1.0f) : make_vec3(1, 0, 0);
    photon.wi = photon.normal;
    photon.power = {float(i), 1, 1};
    photon.map = PHOTON_MAP_SURFACE;
    photon.path = int(engine() % 1000);
    photon.edges = 2 + i % 5;
    maps.photons.push_back(photon);
  }
  maps.build();
  return maps;
}

/// The photons found, by the number in their power.
std::vector<int> found_by(const PhotonTable& table, PhotonSearch search) {
  std::vector<int> found;
  for (int i = next_photon(&table, &search); i >= 0; i = next_photon(&table, &search))
    found.push_back(int(photon_vector(&table, table.powers, i).x));
  return found;
}

// 0 and 1 photons, a table of the fewest buckets, radii of many and of few cells, cells that are clamped.
TEST(PhotonSearch, FindsWhatBruteForceFindsAndNothingTwice) {
  for (const int count : {0, 1, 7, 8, 9, 500, 3000})
    for (const float radius : {1e-6f, 0.05f, 0.3f, 5.0f}) {
      const Maps maps = random_maps(count, radius, 1.0f);
      const PhotonTable table = maps.table();
      for (int k = 0; k < 50; ++k) {
        const vec3 p = make_vec3(0.04f * float(k) - 1, 0.9f - 0.03f * float(k), 0);
        const vec3 normal = make_vec3(0, 0, 1);
        const PhotonSearch search = search_photons(&table, p, normal, false, 4);
        std::set<int> expected;
        for (const Photon& photon : maps.photons) {
          const vec3 d = sub(photon.p, p);
          if (dot3(d, d) <= search.radius2 && std::abs(photon.normal.z) > 0.5f && photon.edges <= 4)
            expected.insert(int(photon.power.x));
        }
        const std::vector<int> found = found_by(table, search);
        EXPECT_EQ(std::set<int>(found.begin(), found.end()), expected) << count << " " << radius;
        EXPECT_EQ(found.size(), expected.size()) << "some are found twice";
      }
    }
}

TEST(PhotonSearch, TheNearestIsOnTheSameSide) {
  const Maps maps = random_maps(3000, 0.3f, 1.0f);
  const PhotonTable table = maps.table();
  const vec3 p = make_vec3(0.1f, 0.2f, 0), normal = make_vec3(0, 0, -1);
  const int nearest = nearest_photon(&table, search_photons(&table, p, normal, false, INT_MAX));
  ASSERT_GE(nearest, 0);
  EXPECT_LT(photon_vector(&table, table.normals, nearest).z, 0);
  const vec3 d = sub(photon_vector(&table, table.p, nearest), p);
  for (const Photon& photon : maps.photons)
    if (photon.normal.z < 0) EXPECT_GE(length3(sub(photon.p, p)), length3(d));
}

// The order in which photons come does not matter, except that of one path.
TEST(PhotonMapBuilder, MakesTheSameMapOfAnyOrder) {
  Maps maps = random_maps(2000, 0.1f, 1.0f);
  for (std::size_t i = 0; i < maps.photons.size(); ++i) maps.photons[i].path = int(i % 1000);
  maps.build();
  const AlignedVector<std::uint32_t> words = maps.words;
  std::vector<Photon> other;
  for (int path = 999; path >= 0; --path)
    for (const Photon& photon : maps.photons)
      if (photon.path == path) other.push_back(photon);
  maps.photons = other;
  maps.build();
  EXPECT_EQ(maps.words, words);
}

TEST(PhotonMapBuilder, APhotonThatIsNotFiniteMakesEstimatesNotFinite) {
  Maps maps = random_maps(10, 0.1f, 1.0f);
  EXPECT_EQ(maps.table().map.share, 1.0f / 1000);
  maps.photons[3].power.y = std::numeric_limits<float>::quiet_NaN();
  maps.build();
  EXPECT_EQ(maps.table().map.count, 9);
  EXPECT_TRUE(std::isnan(maps.table().map.share));
}

}  // namespace
}  // namespace penumbra
