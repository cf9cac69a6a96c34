// Light clusters: what they add to the second moment of the choice, by the kernels' probabilities.
#include "scenes/device/light_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/kernels/light_scenes.h"
#include "tests/kernels/random_numbers.h"

namespace penumbra {
namespace {

/// A small light at that place that shines in all directions.
LightBounds small_light(const Exact3& at, double intensity) {
  LightBounds b;
  b.infinite = false;
  b.low = b.high = glm::dvec3(double(at.x), double(at.y), double(at.z));
  b.intensity = intensity;
  return b;
}

/// That many about a point, within `size` of it.
void add_area_light(std::vector<LightBounds>& lights, const Exact3& at, double size, int count,
                    RandomNumbers& random) {
  for (int k = 0; k < count; ++k)
    lights.push_back(small_light(at + random.point(size), random.between(0.5, 2)));
}

std::vector<PilotVertex> places_in_cube(double size, int count, RandomNumbers& random) {
  std::vector<PilotVertex> places;
  for (int k = 0; k < count; ++k)
    places.push_back({rounded(random.point(size)), rounded(random.direction()), random.between(0.25, 1)});
  return places;
}

std::vector<std::size_t> sizes(std::vector<LightGroup> groups) {
  std::vector<std::size_t> all;
  for (LightGroup& group : groups) {
    all.push_back(group.size());
    std::ranges::sort(group);
    EXPECT_TRUE(std::ranges::adjacent_find(group) == group.end());
  }
  std::ranges::sort(all);
  return all;
}

TEST(LightGroups, AreAreaLightsThatAreSmallFromAfar) {
  RandomNumbers random(71);
  std::vector<LightBounds> lights;
  add_area_light(lights, {0, 0, 30}, 0.05, 40, random);
  add_area_light(lights, {0, 30, 0}, 0.05, 60, random);
  const std::vector<PilotVertex> places = places_in_cube(20, 100, random);
  EXPECT_EQ(sizes(light_groups(lights, 1, places)), (std::vector<std::size_t>{40, 60}));
  // From one side of both, far away, both are one.
  std::vector<PilotVertex> far = places;
  for (PilotVertex& place : far) {
    place.p.x += 3000;
    place.facing = make_vec3(-1, 0, 0);
  }
  EXPECT_EQ(sizes(light_groups(lights, 1, far)), (std::vector<std::size_t>{100}));
}

TEST(LightGroups, AreNotLightsAmongWhatTheyLight) {
  RandomNumbers random(72);
  std::vector<LightBounds> lights;
  for (int k = 0; k < 200; ++k) lights.push_back(small_light(random.point(5), random.between(0.5, 2)));
  const std::vector<LightGroup> groups = light_groups(lights, 1, places_in_cube(5, 200, random));
  for (const LightGroup& group : groups) EXPECT_LT(group.size(), 8u);
}

TEST(LightGroups, AreNoneWithoutPlacesOrLights) {
  RandomNumbers random(73);
  std::vector<LightBounds> lights;
  EXPECT_TRUE(light_groups(lights, 1, places_in_cube(1, 10, random)).empty());
  add_area_light(lights, {0, 0, 3}, 0.01, 20, random);
  EXPECT_TRUE(light_groups(lights, 1, {}).empty());
  // Infinite lights, and those without intensity, are in none.
  lights.push_back(LightBounds{});
  lights.back().intensity = 1;
  lights[3].intensity = 0;
  const std::vector<LightGroup> groups = light_groups(lights, 1, places_in_cube(1, 10, random));
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].size(), 19u);
  for (const int light : groups[0]) EXPECT_TRUE(light < 20 && light != 3);
}

/// Mean over places of the sum of (what a light may contribute)^2 / probability, relative to the square of
/// what all may contribute.
double second_moment(const std::vector<LightBounds>& lights, const LightTree& tree,
                     const std::vector<PilotVertex>& places) {
  const LightTree single = build_light_tree(lights, 1);
  SceneTables tables;
  tables.lights.resize(lights.size());
  tables.light_nodes = tree.nodes;
  tables.light_trails = tree.trails;
  tables.light_members = tree.members;
  tables.light_numbers = tree.numbers;
  tables.header.light_cut = tree.cut;
  tables.header.light_tree_depth = tree.depth;
  tables.header.light_leaf_steps = tree.leaf_turns;
  const Scene scene = tables.scene();
  std::vector<const LightNode*> leaf_of(lights.size(), nullptr);
  for (const LightNode& node : single.nodes)
    if (node.child < 0) leaf_of[std::size_t(~node.child)] = &node;
  double sum = 0, weights = 0;
  for (const PilotVertex& place : places) {
    LitPlace lit;
    lit.p = place.p;
    lit.facing = place.facing;
    LitPlaces lanes;
    for (int j = 0; j < LANES; ++j) store_lit_place(&lanes, j, lit);
    LightScales scales;
    find_light_scales(&scene, &lanes, &scales);
    double moment = 0, all = 0;
    for (std::size_t first = 0; first < lights.size(); first += LANES) {
      FoundLights found{};
      for (int j = 0; j < LANES; ++j)
        found.light[j] = first + std::size_t(j) < lights.size() ? int(first) + j : -1;
      find_tree_pmfs(&scene, &lanes, &scales, &found);
      for (int j = 0; j < LANES && first + std::size_t(j) < lights.size(); ++j) {
        const double light = double(light_importance(leaf_of[first + std::size_t(j)], lit));
        all += light;
        if (light > 0) moment += light * light / double(found.pmf[j]);
      }
    }
    if (!(all > 0)) continue;
    sum += place.weight * moment / (all * all);
    weights += place.weight;
  }
  return sum / weights;
}

// What groups were made to add, over the same places: the flat upper part of the hierarchy may only lower
// both.
TEST(LightGroups, AddLittleToTheSecondMoment) {
  RandomNumbers random(74);
  for (const double size : {0.3, 3.0, 30.0}) {
    std::vector<LightBounds> lights;
    for (int area_light = 0; area_light < 12; ++area_light)
      add_area_light(lights, random.point(5), std::pow(10.0, random.between(-2, 0)), 30, random);
    const std::vector<PilotVertex> places = places_in_cube(size, 200, random);
    const std::vector<LightGroup> groups = light_groups(lights, 1, places);
    const double each = second_moment(lights, build_light_tree(lights, 1, {}, 1), places);
    const double together = second_moment(lights, build_light_tree(lights, 1, groups, 1), places);
    const double flat = second_moment(lights, build_light_tree(lights, 1, groups), places);
    EXPECT_GE(each, 1 - 1e-4);
    // The grouped hierarchy is another one above the groups, too.
    EXPECT_LE(together, each + 0.2) << size;
    EXPECT_LE(flat, together + 0.1) << size;
  }
}

}  // namespace
}  // namespace penumbra
