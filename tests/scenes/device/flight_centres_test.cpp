// Light clusters that illuminate media, for equiangular sampling.
#include "scenes/device/flight_centres.h"

#include <gtest/gtest.h>

#include <cmath>

namespace penumbra {
namespace {

LightBounds area_light(const glm::dvec3& place, double size, double intensity) {
  return {.low = place - size, .high = place + size, .intensity = intensity, .infinite = false};
}

TEST(FlightCentres, AreOfLightsThatAreSomewhereAndShine) {
  const LightBounds sky{.intensity = 5};
  EXPECT_TRUE(flight_centres(std::vector{sky, area_light({1, 2, 3}, 0, 0)}).empty());
  const std::vector<FlightCentre> one = flight_centres(std::vector{sky, area_light({1, 2, 3}, 0, 7)});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].place.y, 2.0f);
  EXPECT_EQ(one[0].size, 0.0f);
  EXPECT_EQ(one[0].below, 1.0f);
}

TEST(FlightCentres, OfManyLightsAreOfGroupsOfNeighbours) {
  // Three clusters of a hundred each, the first of which is as strong as both others.
  std::vector<LightBounds> lights;
  for (int i = 0; i < 300; ++i) {
    const int cluster = i % 3;
    lights.push_back(area_light({100.0 * cluster, 0.01 * i, 0}, 0.001, cluster == 0 ? 2 : 1));
  }
  const std::vector<FlightCentre> centres = flight_centres(lights);
  ASSERT_EQ(centres.size(), 16u);
  double before = 0, shares[3] = {};
  for (const FlightCentre& centre : centres) {
    const double place = double(centre.place.x) / 100, cluster = std::round(place);
    EXPECT_NEAR(place, cluster, 1e-5);
    EXPECT_LT(centre.size, 2);
    ASSERT_GT(double(centre.below), before);
    shares[int(cluster)] += double(centre.below) - before;
    before = double(centre.below);
  }
  EXPECT_EQ(before, 1);
  EXPECT_NEAR(shares[0], 0.5, 1e-6);
  EXPECT_NEAR(shares[1], 0.25, 1e-6);
}

}  // namespace
}  // namespace penumbra
