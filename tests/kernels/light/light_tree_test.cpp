// The light hierarchy: bounds against points of the lights, choices against their probabilities.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "scenes/device/light_tree_builder.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/kernels/scene_tables.h"
#include "tests/support/statistics.h"

namespace penumbra::light_tree_test {
namespace {

/// A triangle, sphere, disk, point or rectangle of a random place, size and power.
Light random_light(RandomNumbers& random, bool flat_only = false) {
  Light light{};
  const double size = std::pow(10.0, random.between(-2, 0));
  const Exact3 place = random.point(3), axis = random.direction();
  light.radiance = make_vec3(1, 1, 1);
  light.polygon = -1;
  light.two_sided = random.below(4) == 0 ? 1 : 0;
  light.p0 = rounded(place);
  switch (random.below(flat_only ? 3 : 5)) {
    case 0:
      light.kind = LIGHT_TRIANGLE;
      light.p1 = rounded(place + (long double)size * random.direction());
      light.p2 = rounded(place + (long double)size * random.direction());
      break;
    case 1: {
      light.kind = LIGHT_RECTANGLE;
      const Exact3 side = normalize(cross(axis, random.direction()));
      light.p1 = rounded(place + (long double)size * side);
      light.p2 = rounded(place + (long double)(0.3 * size) * cross(axis, side));
      break;
    }
    case 2:
      light.kind = LIGHT_DISK;
      light.p1 = rounded(axis);
      light.p2 = make_vec3(float(size), 1, 0);
      break;
    case 3:
      light.kind = LIGHT_SPHERE;
      light.p2 = make_vec3(float(size), 1, 0);
      light.two_sided = 0;
      break;
    default:
      light.kind = LIGHT_POINT;
      light.two_sided = 0;
  }
  return light;
}

struct EmittingPoint {
  Exact3 p, normal;  ///< no normal for points
  bool two_sided;
};

EmittingPoint point_of(const Light& light, RandomNumbers& random) {
  const Exact3 p0 = exact(light.p0), p1 = exact(light.p1), p2 = exact(light.p2);
  const bool two_sided = light.two_sided != 0;
  switch (light.kind) {
    case LIGHT_TRIANGLE:
    case LIGHT_RECTANGLE: {
      long double u = random.uniform(), v = random.uniform();
      if (light.kind == LIGHT_TRIANGLE && u + v > 1) u = 1 - u, v = 1 - v;
      return {p0 + u * (p1 - p0) + v * (p2 - p0), normalize(cross(p1 - p0, p2 - p0)), two_sided};
    }
    case LIGHT_DISK: {
      const Exact3 n = normalize(p1);
      const Exact3 side = normalize(cross(n, random.direction()));
      return {p0 + (long double)(light.p2.x * random.uniform()) * side, n, two_sided};
    }
    case LIGHT_SPHERE: {
      const Exact3 n = random.direction();
      return {p0 + (long double)light.p2.x * n, n, false};
    }
    default:
      return {p0, {0, 0, 0}, false};
  }
}

/// Scenes of `count` lights, with `infinite` infinite ones after them. Leaves are of `together` lights that
/// need not be alike.
struct Lights {
  SceneTables tables;
  std::vector<LightBounds> bounds;
  Scene scene{};

  Lights(std::vector<Light> lights, int infinite, RandomNumbers& random, int together = 1) {
    tables.lights = std::move(lights);
    double intensity = 0;
    for (const Light& light : tables.lights) {
      bounds.push_back(bounds_of_light(light, std::pow(10.0, random.between(-2, 2))));
      intensity += bounds.back().intensity;
    }
    for (int k = 0; k < infinite; ++k) {
      Light sky{};
      sky.kind = LIGHT_ENVIRONMENT;
      sky.polygon = -1;
      tables.lights.push_back(sky);
      LightBounds b = bounds_of_light(sky, 1);
      if (k > 0) {  // others come from around one direction
        const Exact3 axis = random.direction();
        b.axis = glm::normalize(glm::dvec3(double(axis.x), double(axis.y), double(axis.z)));
        b.spread = random.between(0, 1);
      }
      b.intensity = intensity / 9 * random.uniform();
      bounds.push_back(b);
    }
    std::vector<LightGroup> groups;
    const auto finite = int(tables.lights.size()) - infinite;
    for (int k = 0; together > 1 && k < finite; ++k) {
      if (k % together == 0) groups.emplace_back();
      groups.back().push_back(k);
    }
    const LightTree tree = build_light_tree(bounds, intensity > 0 ? 9 / intensity : 1.0, groups);
    tables.light_nodes = tree.nodes;
    tables.light_trails = tree.trails;
    tables.light_members = tree.members;
    tables.light_numbers = tree.numbers;
    tables.header.light_cut = tree.cut;
    tables.header.light_tree_depth = tree.depth;
    tables.header.light_leaf_steps = tree.leaf_turns;
    tables.header.features |= FEATURE_LIGHT_TREE;
    scene = tables.scene();
  }
};

Lights random_lights(int count, int infinite, std::uint64_t seed, int together = 1) {
  RandomNumbers random(seed);
  std::vector<Light> lights;
  for (int k = 0; k < count; ++k) lights.push_back(random_light(random));
  return Lights(std::move(lights), infinite, random, together);
}

LitPlace random_place(RandomNumbers& random) {
  LitPlace place;
  place.p = rounded(random.point(4));
  place.facing = random.below(4) == 0 ? make_vec3(0, 0, 0) : normalize3(rounded(random.direction()));
  return place;
}

struct Choice {
  int light;
  float pmf, u;
};

/// LANES choices at one place.
std::vector<Choice> choose(const Scene& scene, const LitPlace& place, const std::vector<float>& u,
                           const std::vector<float>& fine) {
  LitPlaces places;
  LightSamplings samplings;
  float number[LANES], digits[LANES];
  for (int j = 0; j < LANES; ++j) {
    store_lit_place(&places, j, place);
    number[j] = u[std::size_t(j) % u.size()];
    digits[j] = fine[std::size_t(j) % fine.size()];
  }
  LightScales scales;
  choose_by_tree(&scene, &places, number, digits, &samplings, &scales);
  std::vector<Choice> choices;
  for (int j = 0; j < LANES; ++j) choices.push_back({samplings.light[j], samplings.pmf[j], number[j]});
  return choices;
}

std::vector<float> pmfs(const Scene& scene, const LitPlace& place) {
  const int count = scene.header.tables.lights.count;
  std::vector<float> all;
  LitPlaces places;
  for (int j = 0; j < LANES; ++j) store_lit_place(&places, j, place);
  LightScales scales;
  find_light_scales(&scene, &places, &scales);
  for (int first = 0; first < count; first += LANES) {
    FoundLights found{};
    for (int j = 0; j < LANES; ++j) found.light[j] = first + j < count ? first + j : -1;
    find_tree_pmfs(&scene, &places, &scales, &found);
    for (int j = 0; j < LANES && first + j < count; ++j) all.push_back(found.pmf[j]);
  }
  return all;
}

struct TreeCase {
  int lights, infinite;
  int together = 1;
};
constexpr TreeCase kTreeCases[] = {{1, 0},    {1, 1},     {2, 0},        {0, 4},
                                   {5, 1},    {30, 3},    {1000, 1},     {2, 0, 2},
                                   {5, 1, 5}, {30, 3, 4}, {1000, 1, 30}, {1000, 1, 1000}};
class LightTrees : public testing::TestWithParam<TreeCase> {
 protected:
  Lights lights_ = random_lights(GetParam().lights, GetParam().infinite, 7, GetParam().together);
  RandomNumbers random_{8};
};
INSTANTIATE_TEST_SUITE_P(Sizes, LightTrees, testing::ValuesIn(kTreeCases), [](const auto& tested) {
  const TreeCase& c = tested.param;
  return std::to_string(c.lights) + "And" + std::to_string(c.infinite) +
         (c.together > 1 ? "By" + std::to_string(c.together) : "");
});

TEST_P(LightTrees, ProbabilitiesSumToOneOrNothingArrives) {
  for (int k = 0; k < 300; ++k) {
    const LitPlace place = random_place(random_);
    double sum = 0;
    for (const float p : pmfs(lights_.scene, place)) {
      ASSERT_GE(p, 0);
      sum += double(p);
    }
    // Each turn rounds once, and trees are at most 32 turns deep. What bounds let through that none of the
    // children has is missing.
    ASSERT_LE(sum, 1 + 32 * 0x1p-23);
    const bool drawn = choose(lights_.scene, place, {0.5f}, {0.5f})[0].pmf > 0;
    if (GetParam().lights + GetParam().infinite <= LIGHT_CUT) {
      ASSERT_NEAR(sum, drawn ? 1 : 0, 1e-5);
    }
  }
}

TEST_P(LightTrees, ProbabilitiesOfChoicesAreThoseOfLightsFoundBitByBit) {
  for (int k = 0; k < 200; ++k) {
    const LitPlace place = random_place(random_);
    const std::vector<float> of = pmfs(lights_.scene, place);
    std::vector<float> u, fine;
    for (int j = 0; j < LANES; ++j) {
      u.push_back(random_.unit_float());
      fine.push_back(random_.unit_float());
    }
    for (const Choice& c : choose(lights_.scene, place, u, fine)) {
      if (c.pmf > 0) {
        ASSERT_EQ(c.pmf, of.at(std::size_t(c.light)));
      }
      ASSERT_GE(c.u, 0);
      ASSERT_LT(c.u, 1);
    }
  }
}

// With a number for what is chosen where nothing arrives.
TEST_P(LightTrees, DrawLightsByTheirProbabilities) {
  constexpr int kPlaces = 8, kDraws = 40'000;
  for (int k = 0; k < kPlaces; ++k) {
    const LitPlace place = random_place(random_);
    const std::vector<float> of = pmfs(lights_.scene, place);
    std::vector<double> expected, observed(of.size() + 1, 0.0);
    double sum = 0;
    for (const float p : of) sum += double(p), expected.push_back(double(p) * kDraws);
    expected.push_back(std::max(1 - sum, 0.0) * kDraws);
    for (int draw = 0; draw < kDraws; draw += LANES) {
      std::vector<float> u, fine;
      for (int j = 0; j < LANES; ++j) {
        u.push_back(random_.unit_float());
        fine.push_back(random_.unit_float());
      }
      for (const Choice& c : choose(lights_.scene, place, u, fine))
        ++observed[c.pmf > 0 ? std::size_t(c.light) : of.size()];
    }
    if (expected.back() < 1) {  // the rounding of the sum
      ASSERT_LE(observed.back(), 10);
      expected.pop_back();
      observed.pop_back();
    }
    if (std::ranges::count_if(expected, [](double e) { return e >= 5; }) < 2) continue;
    const auto result = statistics::chi_square_test(observed, expected);
    EXPECT_GT(result.p, statistics::sidak_significance(0.01, kPlaces * int(std::size(kTreeCases))))
        << "place " << k;
  }
}

// What is left of a number has the digits that choosing took: to 40 of the 48 that there are.
TEST(LightTree, StretchesNumbersExactly) {
  RandomNumbers random(3);
  for (int k = 0; k < 200'000; ++k) {
    const int width = 1 + int(std::pow(2.0, random.between(0, 24)) - 1);
    LongNumber x;
    x.high = int(random.below(std::uint64_t(width)));
    x.low = random.unit_float();
    const LongNumber y = stretched(x, width);
    const long double expected = ((long double)x.high + (long double)x.low) / width;
    const long double got = ((long double)y.high + (long double)y.low) / (1 << 24);
    // The digits below: of `low` a relative rounding of its own, times what it is stretched by.
    const long double tolerance = 0x1p-24L * (4 * 0x1p-23L + 2 * 0x1p-24L * (0x1p24L / width));
    ASSERT_NEAR(double(got - expected), 0, double(tolerance)) << x.high << " of " << width;
    ASSERT_GE(y.high, 0);
    ASSERT_LT(y.high, 1 << 24);
  }
}

// Wherever a point of a light brings light to a place, no node on the way to the light says that nothing
// arrives, and none says less than what a bound has to.
TEST(LightTree, BoundsWhatArrives) {
  const Lights lights = random_lights(60, 0, 21);
  const Scene& scene = lights.scene;
  RandomNumbers random(22);
  int arrivals = 0;
  for (int k = 0; k < 400'000; ++k) {
    const auto index = std::size_t(random.below(60));
    LitPlace place = random_place(random);
    const EmittingPoint e = point_of(lights.tables.lights[index], random);
    const Exact3 way = exact(place.p) - e.p;
    const long double d2 = dot(way, way), d = std::sqrt(d2);
    const bool faces = length(exact(place.facing)) > 0, shines = length(e.normal) > 0;
    const long double front = shines ? dot(way, e.normal) / d : 1;
    const long double emitted = e.two_sided ? std::abs(front) : front;
    const long double received = faces ? -dot(way, exact(place.facing)) / d : 1;
    if (!(emitted > 1e-5L && received > 1e-5L)) continue;
    ++arrivals;
    int node = int(lights.tables.light_trails[index] % LIGHT_CUT);
    std::uint32_t trail = lights.tables.light_trails[index] / LIGHT_CUT;
    for (;;) {
      const LightNode& n = lights.tables.light_nodes[std::size_t(node)];
      const long double bound = light_importance(scene.light_nodes + node, place);
      ASSERT_GT(bound, 0);
      const Exact3 off = exact(place.p) - exact(n.center);
      const long double nearest = std::max(dot(off, off), dot(exact(n.half_size), exact(n.half_size)));
      const long double slack = LIGHT_COSINE_SLACK;
      const bool falls = lights.tables.lights[index].kind != LIGHT_SPHERE && shines;
      const long double least =
          (long double)n.intensity * (falls ? emitted - slack : 1) * (faces ? received - slack : 1) / nearest;
      ASSERT_GE(bound, (1 - 1e-5L) * least) << "node " << node << ", light " << index;
      if (n.child < 0) break;
      node = n.child + int(trail & 1u);
      trail >>= 1;
    }
    ASSERT_EQ(~lights.tables.light_nodes[std::size_t(node)].child, int(index));
  }
  EXPECT_GT(arrivals, 50'000);
}

TEST(LightTree, NeverDrawsLightsBehindASurface) {
  RandomNumbers random(31);
  std::vector<Light> lights;
  // Squares and balls on both sides of the plane z = 0, and squares in it and through it.
  for (int k = 0; k < 40; ++k) {
    Light light = random_light(random);
    const bool above = k % 2 == 0;
    light.kind = k % 4 < 2 ? LIGHT_RECTANGLE : LIGHT_SPHERE;
    light.two_sided = 1;
    const float x = float(random.between(-3, 3)), y = float(random.between(-3, 3)),
                z = float(random.between(0.3, 2)) * (above ? 1.0f : -1.0f);
    light.p0 = make_vec3(x, y, k % 8 == 1 ? 0.0f : z);
    light.p1 = make_vec3(x + 0.2f, y, light.p0.z);
    light.p2 = light.kind == LIGHT_SPHERE ? make_vec3(0.25f, 1, 0) : make_vec3(x, y + 0.3f, light.p0.z);
    if (light.kind == LIGHT_SPHERE) light.two_sided = 0;
    lights.push_back(light);
  }
  const Lights tree(lights, 0, random);
  for (int k = 0; k < 200; ++k) {
    LitPlace place;
    place.p = make_vec3(float(random.between(-3, 3)), float(random.between(-3, 3)), 0);
    place.facing = make_vec3(0, 0, 1);
    const std::vector<float> of = pmfs(tree.scene, place);
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (i % 2 == 0)
        ASSERT_GT(of[i], 0) << i;
      else
        ASSERT_EQ(of[i], 0) << i;
    }
    for (float u : {0.0f, 0.3f, 0.7f, 0.9999999f})
      for (const Choice& c : choose(tree.scene, place, {u}, {random.unit_float()})) ASSERT_EQ(c.light % 2, 0);
  }
}

// Lights that face one way send nothing to what is behind all of them.
TEST(LightTree, NeverDrawsFlatLightsFromBehind) {
  RandomNumbers random(32);
  std::vector<Light> lights;
  for (int k = 0; k < 20; ++k) {
    Light light{};
    light.kind = LIGHT_RECTANGLE;
    light.polygon = -1;
    const float x = float(random.between(-3, 3)), y = float(random.between(-3, 3));
    light.p0 = make_vec3(x, y, 1);
    light.p1 = make_vec3(x, y + 0.3f, 1);  // down
    light.p2 = make_vec3(x + 0.3f, y, 1);
    lights.push_back(light);
  }
  const Lights tree(lights, 0, random);
  LitPlace place;
  place.facing = make_vec3(0, 0, 0);
  for (const float z : {0.0f, 0.99f, 1.0f, 1.01f, 5.0f}) {
    place.p = make_vec3(0.1f, 0.2f, z);
    double sum = 0;
    for (const float p : pmfs(tree.scene, place)) sum += double(p);
    EXPECT_NEAR(sum, z < 1 ? 1 : 0, 1e-5) << z;
  }
}

// However unlike, infinite lights and others keep a share of each other.
TEST(LightTree, LeavesInfiniteLightsAndOthersAShare) {
  for (const double intensity : {1e-20, 1e-3, 1.0, 1e3, 1e20}) {
    RandomNumbers random(5);
    Lights lights = random_lights(8, 0, 41);
    lights.tables.lights.push_back({});
    lights.tables.lights.back().kind = LIGHT_ENVIRONMENT;
    LightBounds sky = bounds_of_light(lights.tables.lights.back(), 1);
    sky.intensity = intensity;
    lights.bounds.push_back(sky);
    const LightTree tree = build_light_tree(lights.bounds, 1);
    lights.tables.light_nodes = tree.nodes;
    lights.tables.light_trails = tree.trails;
    lights.tables.header.light_cut = tree.cut;
    lights.tables.header.light_tree_depth = tree.depth;
    const Scene scene = lights.tables.scene();
    for (int k = 0; k < 100; ++k) {
      LitPlace place = random_place(random);
      place.facing = make_vec3(0, 0, 0);
      const std::vector<float> of = pmfs(scene, place);
      ASSERT_GE(of[8], 0.99f * LEAST_LIGHT_SHARE);
      if (of[8] < 0.5f) continue;
      double others = 0;
      for (int i = 0; i < 8; ++i) others += double(of[std::size_t(i)]);
      ASSERT_LE(of[8] + others, 1.00001);
    }
  }
}

// Depth is limited whatever the lights: all in one place, on a line whose gaps double, of powers that do.
TEST(LightTree, IsNeverTooDeep) {
  for (const int shape : {0, 1, 2}) {
    std::vector<LightBounds> lights;
    for (int k = 0; k < 5000; ++k) {
      LightBounds b;
      b.infinite = false;
      b.low = b.high = glm::dvec3(shape == 0 ? 0.0 : std::exp2(-double(k % 900)), 0, 0);
      b.intensity = shape == 2 ? std::exp2(-double(k % 60)) : 1.0;
      lights.push_back(b);
    }
    const LightTree tree = build_light_tree(lights, 1);
    EXPECT_LE(tree.depth, kMaxLightTreeDepth);
    EXPECT_EQ(tree.nodes.size(), 2 * lights.size() - std::size_t(tree.cut));
    for (std::size_t i = 0; i < lights.size(); ++i) {
      int node = int(tree.trails[i] % LIGHT_CUT);
      for (std::uint32_t trail = tree.trails[i] / LIGHT_CUT; tree.nodes[std::size_t(node)].child >= 0;
           trail >>= 1)
        node = tree.nodes[std::size_t(node)].child + int(trail & 1u);
      ASSERT_EQ(tree.nodes[std::size_t(node)].child, ~int(i));
    }
  }
}

// Lights of a leaf are taken there as their intensities are, to one number; none is left out.
TEST(LightTree, LeavesKeepSharesOfIntensity) {
  std::vector<LightBounds> lights(50);
  double all = 0;
  for (std::size_t k = 0; k < lights.size(); ++k) {
    lights[k].infinite = false;
    lights[k].intensity = k == 7 ? 1e-12 : double(k + 1);
    all += lights[k].intensity;
  }
  LightGroup group;
  for (int k = 49; k >= 0; --k) group.push_back(k);
  const LightTree tree = build_light_tree(lights, 1, std::span(&group, 1));
  ASSERT_EQ(tree.nodes.size(), 1u);
  EXPECT_EQ(tree.nodes[0].lights, 50);
  EXPECT_EQ(tree.leaf_turns, 6);
  EXPECT_EQ(tree.depth, 0);
  int start = 0;
  for (std::size_t k = 0; k < group.size(); ++k) {
    const auto light = std::size_t(group[k]);
    EXPECT_EQ(tree.members[k].light, group[k]);
    EXPECT_EQ(tree.members[k].start, start);
    EXPECT_GE(tree.numbers[light], 1);
    // Of 2^24 numbers one for each of 50 lights is not dealt out by intensity.
    EXPECT_NEAR(tree.numbers[light], lights[light].intensity / all * 0x1p24, 51);
    start += tree.numbers[light];
  }
  EXPECT_EQ(start, 1 << 24);
}

TEST(LightTree, LeavesOutLightsWithoutPower) {
  RandomNumbers random(51);
  std::vector<Light> lights{random_light(random), random_light(random), random_light(random)};
  std::vector<LightBounds> bounds;
  for (const Light& light : lights) bounds.push_back(bounds_of_light(light, &light == &lights[1] ? 0 : 1));
  const LightTree tree = build_light_tree(bounds, 1);
  EXPECT_EQ(tree.nodes.size(), 2u);
  SceneTables tables;
  tables.lights = lights;
  tables.light_nodes = tree.nodes;
  tables.light_trails = tree.trails;
  tables.header.light_cut = tree.cut;
  tables.header.light_tree_depth = tree.depth;
  const Scene scene = tables.scene();
  for (int k = 0; k < 100; ++k) EXPECT_EQ(pmfs(scene, random_place(random))[1], 0);
}

}  // namespace
}  // namespace penumbra::light_tree_test
