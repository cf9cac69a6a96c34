// The choice of lights changes noise only: images with the light hierarchy have the same mean as images with
// the choice by power.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "scenes/instances.h"
#include "scenes/transform.h"
#include "tests/acceptance/many_lights.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

struct Way {
  std::string name;
  void (*set)(IntegratorSettings&);
};
void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }

const Way kWays[] = {
    {"PathMis", [](IntegratorSettings& i) { param::max_depth(i) = 3; }},
    {"PathEmitters",
     [](IntegratorSettings& i) {
       param::max_depth(i) = 3;
       param::direct_sampling(i) = DirectSampling::kEmitterOnly;
     }},
    {"PathSolidAngle",
     [](IntegratorSettings& i) {
       param::max_depth(i) = 2;
       param::emitter_sampling(i) = EmitterSampling::kSolidAngle;
     }},
    {"PathProjected",
     [](IntegratorSettings& i) {
       param::max_depth(i) = 2;
       param::emitter_sampling(i) = EmitterSampling::kProjected;
     }},
    {"Direct", [](IntegratorSettings& i) { i = direct_integrator(2, 1); }},
    {"Whitted",
     [](IntegratorSettings& i) {
       use(i, IntegratorKind::kWhitted);
       param::max_depth(i) = 3;
       param::indirect_samples(i) = 2;
     }},
};

class LightChoices : public testing::TestWithParam<std::tuple<std::size_t, Way>> {};
INSTANTIATE_TEST_SUITE_P(Scenes, LightChoices,
                         testing::Combine(testing::Range(std::size_t{0}, many_lights().size()),
                                          testing::ValuesIn(kWays)),
                         [](const auto& tested) {
                           return "Scene" + std::to_string(std::get<0>(tested.param)) +
                                  std::get<1>(tested.param).name;
                         });

TEST_P(LightChoices, AreUnbiased) {
  const auto& [index, way] = GetParam();
  SceneDescription scene = many_lights()[index].scene;
  way.set(scene.integrator);
  resize_film(scene, 24, 16);
  scene.sampler.kind = SamplerKind::kIndependent;
  // By power the faintest of 1000 spots are chosen once in 20 000 samples, and batches of blocks of 16 pixels
  // that meet them now and then only have no normal means.
  scene.sampler.spp = many_lights()[index].name == "1000 spots" ? 2048 : 256;
  const auto by = [&](LightChoice choice, std::uint32_t seed) {
    param::light_choice(scene.integrator) = choice;
    return block_estimate(scene, 16, seed, 4);
  };
  // 24 blocks of grey, each by 16 batches: of Student's t with 15 degrees of freedom squares have a mean of
  // 1.15 and a deviation of 1.84, so this is 4.4 standard errors above.
  const auto result = statistics::z_test(by(LightChoice::kTree, 1), by(LightChoice::kPower, 5000),
                                         {.accepted_fraction = 1, .mean_square = 2.8});
  EXPECT_TRUE(result.passed) << many_lights()[index].name << ": " << result.summary();
}

SceneDescription scene_named(const std::string& name) {
  for (ManyLights& each : many_lights())
    if (each.name == name) return std::move(each.scene);
  throw std::runtime_error("no scene '" + name + "'");
}

/// Probability of the environment where all places choose alike.
float sky_share(const SceneDescription& description, bool embree = false) {
  const DeviceScene scene = build_or_throw(description, embree);
  EXPECT_EQ(scene.header.integrator.light_choice, CHOICE_POWER);
  EXPECT_EQ(scene.header.tables.light_nodes.count, 0);
  return table<Light>(scene, scene.header.tables.lights)[std::size_t(scene.header.environment)].pmf;
}
float sky_share(const std::string& name) { return sky_share(scene_named(name)); }

// What cannot be seen gets little, whatever its radiance, and how far the scene reaches makes no difference.
TEST(SkyShare, IsByWhatArrives) {
  EXPECT_NEAR(sky_share("area light in a closed room under a bright sky"), 0.125, 1e-6);
  EXPECT_LE(sky_share("torch in a field at night"), 0.25f + 1e-6f);
  EXPECT_NEAR(sky_share("room with a window"), 0.5, 1e-6);
  EXPECT_GE(sky_share("torch in a wide field by day"), 0.5f - 1e-6f);
}

// Walls of an instance keep the sky out as those of the scene itself do, whichever intersector traces the
// image.
TEST(SkyShare, IsByWhatArrivesPastInstances) {
  SceneDescription scene = scene_named("area light in a closed room under a bright sky");
  ShapeGroup room{"room", {}, {}};
  std::vector<Shape> area_lights;
  for (const Shape& shape : scene.shapes) {
    if (shape.radiance)
      area_lights.push_back(shape);
    else
      room.shapes.push_back(placed_shape(shape, scaling(glm::dvec3(0.5))).value());
  }
  scene.shapes = std::move(area_lights);
  scene.groups.push_back(std::move(room));
  scene.instances.push_back({"room", 0, scaling(glm::dvec3(2))});
  for (const bool embree : {false, true}) EXPECT_NEAR(sky_share(scene, embree), 0.125, 1e-6) << embree;
}

TEST(SkyShare, IsTheSameEachTime) {
  for (const ManyLights& each : many_lights()) {
    SceneDescription scene = each.scene;
    param::light_choice(scene.integrator) = LightChoice::kTree;
    const DeviceScene a = build_or_throw(scene), b = build_or_throw(scene);
    EXPECT_EQ(a.words, b.words) << each.name;
  }
}

// The same hierarchy whichever intersector traces the image.
TEST(SkyShare, DoesNotDependOnTheIntersector) {
  for (const ManyLights& each : many_lights()) {
    SceneDescription scene = each.scene;
    param::light_choice(scene.integrator) = LightChoice::kTree;
    const DeviceScene a = build_or_throw(scene), b = build_or_throw(scene, true);
    EXPECT_TRUE(std::ranges::equal(table<std::uint32_t>(a, a.header.tables.light_trails),
                                   table<std::uint32_t>(b, b.header.tables.light_trails)));
    const auto of_a = table<LightNode>(a, a.header.tables.light_nodes),
               of_b = table<LightNode>(b, b.header.tables.light_nodes);
    ASSERT_EQ(of_a.size(), of_b.size());
    for (std::size_t i = 0; i < of_a.size(); ++i) EXPECT_EQ(of_a[i].intensity, of_b[i].intensity);
  }
}

// A scene of one light has no hierarchy, and none is stored.
TEST(LightChoice, CostsNothingWhereThereIsNone) {
  SceneDescription scene = many_lights()[2].scene;
  scene.emitters.clear();
  std::erase_if(scene.shapes, [](const Shape& s) { return s.radiance.has_value(); });
  PointLight area_light;
  area_light.position = {0, 2, 0};
  scene.emitters.emplace_back(area_light);
  const DeviceScene one = build_or_throw(scene);
  EXPECT_EQ(one.header.features & FEATURE_LIGHT_TREE, 0u);
  EXPECT_EQ(one.header.integrator.light_choice, CHOICE_POWER);
  EXPECT_EQ(one.header.tables.light_nodes.count, 0);
  EXPECT_EQ(one.header.tables.light_trails.count, 0);
  scene.emitters.emplace_back(area_light);
  EXPECT_EQ(build_or_throw(scene).header.features & FEATURE_LIGHT_TREE, 0u) << "two in one place";
  area_light.position.x = 1;
  scene.emitters.back() = area_light;
  const DeviceScene two = build_or_throw(scene);
  EXPECT_NE(two.header.features & FEATURE_LIGHT_TREE, 0u);
  EXPECT_EQ(two.header.tables.light_nodes.count, 2);
}

}  // namespace
}  // namespace penumbra
