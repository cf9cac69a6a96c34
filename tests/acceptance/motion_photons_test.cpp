// Photon maps of scenes in which something moves.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/acceptance/motion_pieces.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra::motion_photons_test {
namespace {

using namespace motion_pieces;

TestDevice one_map_a_sample() {
  TestDevice device = native_device();
  device.samples_per_pass = 1;
  return device;
}

/// Radii do not shrink, so that each map has the same bias.
IntegratorSettings same_radii() {
  ProgressivePhotonIntegrator ppm;
  ppm.photon_count = 1000;
  ppm.initial_radius = 0.4f;
  ppm.alpha = 1.0f;
  ppm.max_depth = 4;
  return {.method = ppm};
}

struct Case {
  std::string name;
  bool object = false, area_light = false, point_light = false, camera = false;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

SceneDescription scene_of_case(const Case& c, const IntegratorSettings& integrator) {
  SceneDescription scene = scene_of(cube(kGrey) +
                                    "<emitter type='point'><point name='position' x='-1.5' y='1.5' z='-1'/>"
                                    "<rgb name='intensity' value='2 1 1'/></emitter>");
  scene.integrator = integrator;
  Mover move(scene);
  if (c.object) move.shape(2, move.node({1.4, 0.5, 0}, 80));
  if (c.area_light) move.shape(1, move.node({-2.5, 0.8, 0}, 70, {0, 0, 1}, {1, 3, 0}));
  if (c.point_light) move.emitter(0, move.node({2.4, 0.3, 0.5}));
  if (c.camera) move.camera(move.node({0.9, 0.2, 0.8}, 9, {0.1, 1, 0.2}));
  return scene;
}

class MotionPhotons : public testing::TestWithParam<Case> {};

TEST_P(MotionPhotons, ProgressiveMapsAreTheMeanOfStills) {
  expect_mean_of_stills(scene_of_case(GetParam(), same_radii()), one_map_a_sample());
}

TEST_P(MotionPhotons, FixedMapsShowTheMiddle) {
  PhotonMapIntegrator maps;
  maps.global_photons = maps.caustic_photons = 3000;
  maps.photon_radius = 0.4f;
  SceneDescription scene = scene_of_case(GetParam(), {.method = maps});
  scene.sampler.spp = 16;
  const statistics::Estimate blurred = block_estimate(scene, kBatches, 1, kBlock);
  scene.camera.shutter = 0.0f;
  ASSERT_TRUE(set_time(scene, 0.5));
  ASSERT_EQ(build_or_throw(scene).header.features & FEATURE_MOTION, 0u);
  const statistics::Estimate still = block_estimate(scene, kBatches, 101, kBlock);
  const auto result = statistics::z_test(blurred, still, {.significance = kSignificance});
  EXPECT_TRUE(result.passed) << result.summary();
  RecordProperty("z", result.summary());
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, MotionPhotons,
    testing::Values(
        Case{.name = "Object", .object = true}, Case{.name = "AreaLight", .area_light = true},
        Case{.name = "PointLight", .point_light = true},
        Case{.name = "Everything", .object = true, .area_light = true, .point_light = true, .camera = true}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace penumbra::motion_photons_test
