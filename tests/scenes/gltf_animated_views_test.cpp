// Cameras and lights of animated glTF, KHR_animation_pointer, and animations that are errors.
#include <gmock/gmock.h>

#include <limits>
#include <numbers>

#include "tests/scenes/gltf_motion.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr const char* kCamera =
    R"(, "cameras": [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.5}}])";

TEST_F(GltfMotion, CamerasMoveAndZoom) {
  GltfFile file = triangle();
  const float s = std::sqrt(0.5f);
  SceneDescription scene = good_gltf(file.text(moving(
      {{of_node(0, "translation"), vectors(file, {0, 2}, {0, 0, 0, 4, 0, 0})},
       {of_node(0, "rotation"), keys<float>(file, {0, 2}, "VEC4", 4, {0, 0, 0, 1, 0, s, 0, s})},
       {of_pointer("/cameras/0/perspective/yfov"), keys<float>(file, {0, 2}, "SCALAR", 1, {0.5f, 1.5f})}},
      R"(, "camera": 0)", kCamera)));
  EXPECT_NEAR(scene.camera.fov, 0.5 * kDegrees, kSingle);
  EXPECT_EQ(scene.camera.fov_axis, FovAxis::kY);
  // A half of a quarter turn about y brings -z to (-s, 0, -s), and -x to (-s, 0, s).
  show(scene, 1);
  EXPECT_NEAR(scene.camera.fov, 1.0 * kDegrees, kSingle * kDegrees);
  const double h = std::sqrt(0.5);
  expect_near(glm::dvec3(scene.camera.to_world[3]), {2, 0, 0});
  expect_near(glm::dvec3(scene.camera.to_world[2]), {-h, 0, -h});
  expect_near(glm::dvec3(scene.camera.to_world[0]), {-h, 0, h});
  expect_near(glm::dvec3(scene.camera.to_world[1]), {0, 1, 0});
}

TEST_F(GltfMotion, ShearedCamerasKeepTheirViewAsAtRest) {
  GltfFile file = triangle();
  const std::string scale = vectors(file, {0, 1}, {1, 1, 1, 1, 2, 1});
  const auto text = [&](std::string_view parent, std::string_view more) {
    return file.text(fmt::format(
        R"("scenes": [{{"nodes": [0]}}], "nodes": [{{"children": [1]{0}}},
{{"camera": 0, "rotation": [{1}, 0, 0, {2}]}}, {{"mesh": 0}}], "meshes": [{{"primitives": [{3}]}}]{4}{5})",
        parent, std::sin(std::numbers::pi / 8), std::cos(std::numbers::pi / 8), kTriangle, kCamera, more));
  };
  SceneDescription scene =
      good_gltf(text("", fmt::format(R"(, "animations": [{}])", clip({{of_node(0, "scale"), scale}}))));
  const SceneDescription still = good_gltf(text(R"(, "scale": [1, 2, 1])", ""));
  show(scene, 1);
  for (int axis = 0; axis < 4; ++axis)
    expect_near(glm::dvec3(scene.camera.to_world[axis]), glm::dvec3(still.camera.to_world[axis]), 1e-12);
}

TEST_F(GltfMotion, OrthographicCamerasZoom) {
  GltfFile file = triangle();
  SceneDescription scene = good_gltf(file.text(moving(
      {{of_pointer("/cameras/0/orthographic/xmag"), keys<float>(file, {0, 1}, "SCALAR", 1, {4, 8})},
       {of_pointer("/cameras/0/orthographic/ymag"), keys<float>(file, {0, 1}, "SCALAR", 1, {2, 4})}},
      R"(, "camera": 0, "translation": [0, 0, 7])",
      R"(, "cameras": [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}}])")));
  EXPECT_EQ(scene.film.width, 2 * scene.film.height) << "as the keys at 0 s say";
  EXPECT_EQ(scene.camera.scale_x, 4.0);
  EXPECT_EQ(scene.camera.scale_y, 4.0);
  show(scene, 0.5);
  EXPECT_EQ(scene.camera.scale_x, 6.0);
  EXPECT_EQ(scene.camera.scale_y, 6.0);
  expect_near(glm::dvec3(scene.camera.to_world[3]), {0, 0, 7}, 0.0);
}

std::string lights(std::string_view type) {
  return fmt::format(
      R"(, "extensions": {{"KHR_lights_punctual": {{"lights": [{{"type": "{}", "spot": {{}}, "intensity": 1366, "color": [1, 0.5, 0.25]}}]}}}})",
      type);
}
constexpr const char* kLit = R"(, "extensions": {"KHR_lights_punctual": {"light": 0}})";

TEST_F(GltfMotion, LightsMoveAndChange) {
  GltfFile file = triangle();
  const std::string move = vectors(file, {0, 1}, {0, 0, 0, 2, 0, 0}),
                    turn = keys<float>(file, {0, 1}, "VEC4", 4, {0, 0, 0, 1, 1, 0, 0, 0}),
                    brighter = keys<float>(file, {0, 1}, "SCALAR", 1, {683, 2049}),
                    colour = vectors(file, {0, 1}, {1, 1, 1, 0, 1, 0});
  const std::string intensity = "/extensions/KHR_lights_punctual/lights/0/intensity",
                    color = "/extensions/KHR_lights_punctual/lights/0/color";
  SceneDescription point = good_gltf(file.text(
      moving({{of_node(0, "translation"), move}, {of_pointer(intensity), brighter}}, kLit, lights("point"))));
  show(point, 0.5);
  expect_near(only<PointLight>(point).position, {1, 0, 0}, 0.0);
  expect_near(only<PointLight>(point).intensity, {2, 1, 0.5});
  SceneDescription spot = good_gltf(
      file.text(moving({{of_node(0, "rotation"), turn}, {of_pointer(color), colour}}, kLit, lights("spot"))));
  EXPECT_EQ(only<SpotLight>(spot).intensity, glm::vec3(2.0f));
  show(spot, 0.5);
  // Half of half a turn about x brings -z to y.
  expect_near(glm::dvec3(only<SpotLight>(spot).to_world[2]), {0, 1, 0});
  expect_near(only<SpotLight>(spot).intensity, {1, 2, 1});
  SceneDescription sun =
      good_gltf(file.text(moving({{of_node(0, "rotation"), turn}}, kLit, lights("directional"))));
  show(sun, 1);
  expect_near(only<DirectionalLight>(sun).direction, {0, 0, 1});
  expect_near(only<DirectionalLight>(sun).irradiance, {2, 1, 0.5});
}

TEST_F(GltfMotion, PointersLeadToNodes) {
  GltfFile file = triangle();
  SceneDescription scene = good_gltf(file.text(moving(
      {{of_pointer("/nodes/0/translation"), vectors(file, {0, 1}, {0, 0, 0, 1, 0, 0})},
       {of_pointer("/nodes/0/scale"), vectors(file, {0, 1}, {1, 1, 1, 3, 3, 3})}},
      "",
      R"(, "extensionsUsed": ["KHR_animation_pointer"], "extensionsRequired": ["KHR_animation_pointer"])")));
  expect_near(vertex(scene, 1, 1), {4, 0, 0}, 0.0);
}

TEST_F(GltfMotion, WhatCannotChangeIsNamedOnce) {
  GltfFile file = triangle();
  const std::string numbers = keys<float>(file, {0, 1}, "SCALAR", 1, {0, 1});
  const SceneDescription scene =
      good_gltf(file.text(moving({{of_node(0, "translation"), vectors(file, {0, 1}, {0, 0, 0, 1, 0, 0})},
                                  {of_node(0, "colour"), numbers},
                                  {of_pointer("/materials/0/pbrMetallicRoughness/metallicFactor"), numbers},
                                  {of_pointer("/materials/1/pbrMetallicRoughness/metallicFactor"), numbers},
                                  {R"({"path": "translation"})", numbers}})));
  EXPECT_THAT(
      warnings(scene),
      AllOf(HasSubstr("the animation of '/materials/{}/pbrMetallicRoughness/metallicFactor' is ignored: it "
                      "does not change (2"),
            HasSubstr("the animation of '/nodes/{}/colour' is ignored")));
}

struct BadAnimation {
  std::string name;
  std::string animation;  ///< accessors 2 to 7 are those of the test
  std::string error;
};
class BadGltfMotion : public GltfMotion, public ::testing::WithParamInterface<BadAnimation> {
 public:
  static std::string with(std::string_view path, int input, int output,
                          std::string_view interpolation = "LINEAR") {
    return clip({{of_node(0, path), sampler(input, output, interpolation)}});
  }
  static std::string twice() {
    return clip({{of_node(0, "scale"), sampler(2, 3)}, {of_pointer("/nodes/0/scale"), sampler(2, 3)}});
  }
  static std::string pointed(std::string_view pointer, int output) {
    return clip({{of_pointer(pointer), sampler(2, output)}});
  }
  static std::string of_other(int node, std::string_view path, int output) {
    return clip({{of_node(node, path), sampler(2, output)}});
  }
};

TEST_P(BadGltfMotion, IsAClearErrorWithItsPlace) {
  GltfFile file = triangle();
  const auto times = [&](const std::vector<float>& numbers) {
    return file.accessor<float>("SCALAR", numbers, numbers.size());
  };
  ASSERT_EQ(times({0, 1}), 2);
  file.accessor<float>("VEC3", {1, 1, 1, 2, 2, 2}, 2);                                       // 3
  times({0, 2, 2});                                                                          // 4
  times({0, 2, 1});                                                                          // 5
  times({0, std::nanf("")});                                                                 // 6
  times({-1, 1});                                                                            // 7
  times({});                                                                                 // 8
  file.accessor<float>("VEC3", {0, 0, 0, 1, 1, 1, 2, 2, 2}, 3);                              // 9
  file.accessor<float>("VEC3", {0, 0, 0, 1, std::numeric_limits<float>::infinity(), 1}, 2);  // 10
  file.accessor<std::int16_t>("VEC4", {0, 0, 0, 1, 0, 0, 0, 1}, 2);                          // 11
  file.accessor<std::uint8_t>("SCALAR", {0, 1}, 2);                                          // 12
  times({0, 4});                                                                             // 13
  const std::string message = gltf_error(file.text(fmt::format(
      R"("scenes": [{{"nodes": [0, 1, 2]}}], "nodes": [{{"mesh": 0}}, {{"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}},
{{"mesh": 1, "camera": 0}}], "cameras": [{{"type": "perspective", "perspective": {{"yfov": 1.0, "znear": 0.5}}}}],
"extensions": {{"KHR_lights_punctual": {{"lights": [{{"type": "point"}}]}}}},
"meshes": [{{"primitives": [{0}]}}, {{"primitives": [{{"attributes": {{"POSITION": 0}}, "targets": [{{}}, {{}}]}}]}}],
"animations": [{1}])",
      kTriangle, GetParam().animation)));
  EXPECT_THAT(message, HasSubstr("scene.gltf:"));
  EXPECT_THAT(message, HasSubstr(GetParam().error));
}

using B = BadGltfMotion;
INSTANTIATE_TEST_SUITE_P(
    All, BadGltfMotion,
    ::testing::Values(
        BadAnimation{"EqualTimes", B::with("scale", 4, 9),
                     "accessor 4: times must ascend: key 2 at 2 s comes after 2 s"},
        BadAnimation{"TimesOutOfOrder", B::with("scale", 5, 9),
                     "accessor 5: times must ascend: key 2 at 1 s comes after 2 s"},
        BadAnimation{"TimesThatAreNoNumbers", B::with("scale", 6, 3),
                     "accessor 6 has numbers that are not finite"},
        BadAnimation{"NegativeTimes", B::with("scale", 7, 3), "the time of a key is at least 0 s, not -1"},
        BadAnimation{"NoKeys", B::with("scale", 8, 3), "an animation needs at least one key"},
        BadAnimation{"TimesAreVectors", B::with("scale", 3, 3), "accessor 3 is not of numbers"},
        BadAnimation{"TimesAreIntegers", B::with("scale", 12, 3), "accessor 12: times are floats"},
        BadAnimation{"TooManyValues", B::with("scale", 2, 9), "accessor 9 has 3 elements; 2 keys need 2"},
        BadAnimation{"NoTangents", B::with("scale", 2, 3, "CUBICSPLINE"),
                     "accessor 3 has 2 elements; 2 keys, each with two tangents, need 6"},
        BadAnimation{"InfiniteValues", B::with("translation", 2, 10),
                     "accessor 10 has numbers that are not finite"},
        BadAnimation{"RotationsOfThree", B::with("rotation", 2, 3), "accessor 3 is not of vectors of 4"},
        BadAnimation{"RotationsOfIntegers", B::with("rotation", 2, 11),
                     "whole numbers, which must be normalised"},
        BadAnimation{"NoSuchInput", B::with("scale", 99, 3), "there is no accessor 99"},
        BadAnimation{"NoSuchOutput", B::with("scale", 2, 99), "there is no accessor 99"},
        BadAnimation{"UnknownInterpolation", B::with("scale", 2, 3, "BEZIER"),
                     "'BEZIER' is no interpolation: LINEAR, STEP, CUBICSPLINE"},
        BadAnimation{"TwoChannelsOfOneTarget", B::twice(),
                     "two channels of the animation change '/nodes/0/scale'"},
        BadAnimation{"NodeWithMatrix", B::of_other(1, "translation", 3), "node 1 has a 'matrix'"},
        BadAnimation{"NoSuchNode", B::of_other(9, "scale", 3),
                     "'/nodes/9/scale' leads to nothing: there are 3"},
        BadAnimation{"WeightsOfNothing", B::of_other(0, "weights", 2), "node 0 has no morph targets"},
        BadAnimation{"WeightsOfOneOfTwo", B::of_other(2, "weights", 2),
                     "accessor 2 has 2 elements; 2 keys of 2 weights need 4"},
        BadAnimation{
            "NoSuchSampler",
            R"({"channels": [{"sampler": 1, "target": {"node": 0, "path": "scale"}}], "samplers": [{"input": 2, "output": 3}]})",
            "'sampler' is one of the animation's 1"},
        BadAnimation{
            "NoPointer",
            R"({"channels": [{"sampler": 0, "target": {"path": "pointer"}}], "samplers": [{"input": 2, "output": 3}]})",
            "has a pointer of KHR_animation_pointer"},
        BadAnimation{"NoChannels", R"({"samplers": []})",
                     "an object with the arrays 'channels' and 'samplers'"},
        BadAnimation{"NoTarget", R"({"channels": [{"sampler": 0}], "samplers": [{"input": 2, "output": 3}]})",
                     "a channel has a 'target'"},
        BadAnimation{"NoSuchLight", B::pointed("/extensions/KHR_lights_punctual/lights/3/color", 3),
                     "leads to nothing: there are 1"},
        BadAnimation{"WideAngle", B::pointed("/cameras/0/perspective/yfov", 13),
                     "yfov must be between 0 and pi"},
        BadAnimation{"OtherProjection", B::pointed("/cameras/0/orthographic/xmag", 2),
                     "camera 0 is not orthographic"},
        BadAnimation{"NegativeIntensity", B::pointed("/extensions/KHR_lights_punctual/lights/0/intensity", 7),
                     "an intensity must be at least 0"},
        BadAnimation{"FadingVisibility", B::pointed("/nodes/0/extensions/KHR_node_visibility/visible", 12),
                     "visibility changes by STEP only"}),
    [](const auto& test) { return test.param.name; });

TEST_F(GltfMotion, ErrorsAreAtTheSampler) {
  GltfFile file = triangle();
  const int times = file.accessor<float>("SCALAR", {1, 0}, 2),
            values = file.accessor<float>("VEC3", {1, 1, 1, 2, 2, 2}, 2);
  EXPECT_THAT(gltf_error(file.text(fmt::format(
                  "\"nodes\": [{{}}],\n\"animations\": [{{\"channels\": [{{\"sampler\": 0, \"target\": "
                  "{{\"node\": 0, "
                  "\"path\": \"scale\"}}}}],\n\"samplers\": [{{\"input\": {}, \"output\": {}}}]}}]",
                  times, values))),
              HasSubstr("scene.gltf:5:24: error: accessor 2: times must ascend"));
}

TEST_F(GltfMotion, SplinesThatLeaveTheirRangeAreErrorsAtTheirTime) {
  GltfFile file = triangle();
  // Between equal values 0.1 the tangents lead below 0.
  SceneDescription scene = good_gltf(
      file.text(moving({{of_pointer("/extensions/KHR_lights_punctual/lights/0/intensity"),
                         keys<float>(file, {0, 1}, "SCALAR", 1, {0, 0.1f, -8, 8, 0.1f, 0}, "CUBICSPLINE")}},
                       kLit, lights("point"))));
  const auto done = set_time(scene, 0.5);
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().message, HasSubstr("a light at time 0.5 s: its strength must be at least 0"));
}

}  // namespace
}  // namespace penumbra
