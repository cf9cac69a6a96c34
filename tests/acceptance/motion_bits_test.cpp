// Blurred images have the same bits from every backend, and however the film is divided.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/kernel_needs.h"
#include "tests/acceptance/motion_pieces.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra::motion_bits_test {
namespace {

using namespace motion_pieces;

struct Case {
  std::string name;
  std::function<SceneDescription()> scene;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

const std::string kLights =
    "<emitter type='point'><point name='position' x='-1.5' y='0.5' z='-1'/>"
    "<rgb name='intensity' value='2 1 1'/></emitter>"
    "<emitter type='spot'><transform name='to_world'><lookat origin='2, 2, -2' target='0, -0.5, 0' "
    "up='0, 1, 0'/></transform><rgb name='intensity' value='3 9 3'/><float name='cutoff_angle' "
    "value='25'/></emitter>"
    "<emitter type='spot'><transform name='to_world'><lookat origin='-2, 2, -2' target='0, -0.5, 0' "
    "up='0, 1, 0'/></transform><rgb name='intensity' value='3 3 9'/><float name='radius' value='0.3'/>"
    "</emitter><emitter type='directional'><vector name='direction' value='1 -1 1'/><float name='angle' "
    "value='20'/></emitter>";
const std::string kRound =
    "<shape type='sphere'><float name='radius' value='0.3'/><point name='center' x='-1' y='0.4' z='0'/>"
    "<emitter type='area'><rgb name='radiance' value='6 1 1'/></emitter></shape>";

std::vector<Case> cases() {
  return {
      {"Everything",
       [] {
         SceneDescription scene =
             scene_of(cube(kGrey) + cube(kGrey, "<translate x='-1.4' z='1'/>") + kLights + kRound);
         scene.camera.aperture_radius = 0.1;
         scene.camera.focus_distance = 5;
         scene.camera.rolling_shutter = 0.4;
         scene.camera.shutter = 0.6f;
         scene.camera.shutter_curve = kTriangleShutter;
         scene.film.layers = {AskedLayer::kMotion};
         Mover move(scene);
         move.shape(1, move.node({-2.5, 0.8, 0}, 70, {0, 0, 1}, {1, 3, 0}));
         move.shape(2, move.node({1.4, 0.5, 0}, 80));
         move.deform(3, [](const glm::dvec3& p) { return glm::dvec3(0.9 * p.y, 0.5 * p.x, -0.6 * p.z); });
         move.shape(4, move.node({1.1, 0.5, 0}, 0, {0, 1, 0}, {-1, 0.4, 0}, 0.6));
         for (std::size_t i = 0; i < scene.emitters.size(); ++i)
           move.emitter(i, move.node({0.8, 0.3, 0.5}, 25, {0.2, 0.5, 1}));
         move.camera(move.node({0.3, 0.1, 0.2}, 5, {0.1, 1, 0.2}));
         return scene;
       }},
      {"ClosedForms",
       [] {
         SceneDescription scene =
             scene_of(cube(kGrey), "<integrator type='path'><string name='nee' value='cv'/></integrator>");
         Mover move(scene);
         move.shape(1, move.node({-2.5, 0.8, 0}, 70, {0, 0, 1}, {1, 3, 0}));
         move.last_shape(move.node({0.8, 0.4, 0}, 50));
         return scene;
       }},
      {"Medium",
       [] {
         SceneDescription scene = scene_of(
             "<shape type='cube'><transform name='to_world'><scale value='0.7'/></transform>"
             "<bsdf type='null'/><medium type='homogeneous' name='interior'>"
             "<rgb name='sigma_t' value='1.5 1 0.7'/><rgb name='albedo' value='0.9 0.8 0.7'/></medium>"
             "</shape>" +
                 kRound,
             "<integrator type='volpath'/>");
         Mover move(scene);
         move.shape(2, move.node({1.0, 0.3, 0}, 60));
         move.shape(3, move.node({1.1, 0.5, 0}));
         return scene;
       }},
      {"Instances",
       [] {
         SceneDescription scene =
             scene_of("<shape type='shapegroup' id='pair'>" +
                      cube(kGrey, "<scale value='0.4'/><translate x='-0.4'/>") +
                      "<shape type='sphere'><float name='radius' value='0.3'/>"
                      "<point name='center' x='0.4' y='0.1' z='0'/><bsdf type='diffuse'/></shape></shape>"
                      "<shape type='instance'><ref id='pair'/><transform name='to_world'><translate y='0.6'/>"
                      "</transform></shape><shape type='instance'><ref id='pair'/><transform name='to_world'>"
                      "<scale x='1.5' y='0.7'/><translate y='-0.5'/></transform></shape>");
         Mover move(scene);
         move.instance(0, move.node({0.7, 0.2, 0}, 110, {0, 0, 1}, {0, 0.6, 0}));
         return scene;
       }},
  };
}

class MotionBits : public testing::TestWithParam<Case> {};

TEST_P(MotionBits, AreThoseOfEveryBackend) {
  SceneDescription description = GetParam().scene();
  description.sampler.spp = 6;
  ASSERT_TRUE(set_time(description, 0));
  const DeviceScene scene = build_or_throw(description);
  ASSERT_NE(scene.header.features & FEATURE_MOTION, 0u);
  TestDevice device = native_device();
  device.options.threads = 1;
  device.options.block_of_one = true;
  const FilmAccumulator reference = render_or_throw(scene, device);
  ASSERT_GT(reference.at(kSide / 2, kSide / 2).count, 0u);
  const auto expect_same = [&](const TestDevice& other, const std::string& name) {
    const FilmAccumulator film = render_or_throw(scene, other);
    EXPECT_EQ(film.hash(), reference.hash()) << name;
  };
  device.options.block_of_one = false;
  std::string tried;
  for (const Isa isa : usable_isas()) {
    device.options.isa = isa;
    for (const int threads : {1, 2}) {
      device.options.threads = threads;
      expect_same(device, std::string(isa_name(isa)) + " with " + std::to_string(threads) + " threads");
    }
    tried += std::string(isa_name(isa)) + " ";
  }
  RecordProperty("isas", tried);
}

TEST_P(MotionBits, AreThoseOfOpenClKernelsForTheSceneAlone) {
  SceneDescription description = GetParam().scene();
  description.sampler.spp = 6;
  const DeviceScene scene = build_or_throw(description);
  EXPECT_EQ(render_or_throw(scene, opencl_device()).hash(), render_or_throw(scene).hash());
}

TEST(MotionBitsOfOpenCl, AreThoseOfNativeKernels) {
  std::vector<DeviceScene> scenes;
  for (const Case& each : cases()) {
    SceneDescription description = each.scene();
    description.sampler.spp = 6;
    description.film.layers = {AskedLayer::kMotion};
    scenes.push_back(build_or_throw(description));
  }
  share_needs(scenes);
  for (std::size_t i = 0; i < scenes.size(); ++i)
    EXPECT_EQ(render_or_throw(scenes[i], opencl_device()).hash(), render_or_throw(scenes[i]).hash())
        << cases()[i].name;
}

TEST_P(MotionBits, DoNotDependOnTiles) {
  SceneDescription description = GetParam().scene();
  description.sampler.spp = 6;
  ASSERT_TRUE(set_time(description, 0));
  const DeviceScene scene = build_or_throw(description);
  const FilmAccumulator whole = render_or_throw(scene);
  const auto device = make_device(scene, native_device().options);
  ASSERT_TRUE(device) << device.error().message;
  for (const auto& [width, height] : {std::pair(7, 5), {kSide, 1}, {1, 1}}) {
    SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height));
    FilmAccumulator film = whole.empty_like(0, 0, kSide, kSide);
    for (int y = 0; y < kSide; y += height)
      for (int x = 0; x < kSide; x += width) {
        const auto tile = (*device)->render({.x = x,
                                             .y = y,
                                             .width = std::min(width, kSide - x),
                                             .height = std::min(height, kSide - y),
                                             .first_sample = 0,
                                             .sample_count = scene.header.sampler.spp});
        ASSERT_TRUE(tile) << tile.error().message;
        film.add(x, y, *tile);
      }
    EXPECT_EQ(film.hash(), whole.hash());
  }
}

TEST_P(MotionBits, PassesTakeTheSameSamples) {
  SceneDescription scene = GetParam().scene();
  scene.sampler.spp = 12;
  // Otherwise each pass fits it to its own samples.
  with_parameter(scene.integrator, PENUMBRA_PARAMETER(alpha),
                 [](std::optional<float>& alpha) { alpha = 1.0f; });
  ASSERT_TRUE(set_time(scene, 0));
  TestDevice device = native_device();
  const FilmAccumulator whole = render_or_throw(scene, device);
  device.samples_per_pass = 5;
  const FilmAccumulator passes = render_or_throw(scene, device);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c) {
        // The same samples, rounded to single precision as means of 12 or of 5, 5 and 2; those of control
        // variates, of about 1, may cancel.
        const double a = whole.at(x, y).mean[c];
        EXPECT_NEAR(passes.at(x, y).mean[c], a, 1e-5 * std::abs(a) + 1e-6);
      }
}

/// By OpenCL kernels compiled for more than the scene has, and those of a scene in which nothing moves by
/// kernels that can move.
TEST(MotionBitsOfKernels, ForMoreThanTheSceneHasAreTheSame) {
  for (const bool moves : {true, false}) {
    SCOPED_TRACE(moves ? "moves" : "still");
    SceneDescription description = cases()[1].scene();
    description.sampler.spp = 4;
    if (!moves) description.camera.shutter = 0.0f;
    const DeviceScene own = build_or_throw(description);
    EXPECT_EQ((own.header.features & FEATURE_MOTION) != 0, moves);
    const FilmAccumulator expected = render_or_throw(own);
    DeviceScene all = own;
    all.header.features = (FEATURE_ALL & ~(FEATURE_BVH | FEATURE_DENOISING | LAYERS_ON_DEMAND)) |
                          (own.header.features & FEATURE_BVH);
    all.header.families = kEveryFamily;
    all.header.light_kinds = ALL_LIGHT_KINDS;
    const FilmAccumulator found = render_or_throw(all, opencl_device());
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        for (int c = 0; c < 3; ++c)
          EXPECT_EQ(found.at(x, y).mean[c], expected.at(x, y).mean[c]) << x << ", " << y;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, MotionBits, testing::ValuesIn(cases()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace penumbra::motion_bits_test
