// Animations of glTF: interpolations in closed form, clips, what moves and what vanishes.
#include <gmock/gmock.h>

#include <numbers>

#include "tests/scenes/gltf_motion.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// Vertex 0 of the triangle is at its node's origin, vertex 1 at (1, 0, 0), vertex 2 at (0, 1, 0).

TEST_F(GltfMotion, LinearTranslation) {
  GltfFile file = triangle();
  SceneDescription scene =
      good_gltf(file.text(moving({{of_node(0, "translation"), vectors(file, {1, 3}, {1, 0, 0, 5, 0, -2})}})));
  EXPECT_THAT(warnings(scene), HasSubstr("the scene moves; it is shown as at 0 s"));
  expect_near(mesh(scene).positions[0], {1, 0, 0}, 0.0);
  expect_near(vertex(scene, 2.5, 0), {4, 0, -1.5});
  expect_near(vertex(scene, 9, 0), {5, 0, -2}, 0.0);
  expect_near(vertex(scene, 0.5, 0), {1, 0, 0}, 0.0);
  ASSERT_NE(scene.motion, nullptr);
  EXPECT_EQ(scene.motion->clips.size(), 1u);
  EXPECT_EQ(scene.motion->clips[0].name, "0");
  EXPECT_EQ(scene.motion->clips[0].first, 1.0);
  EXPECT_EQ(scene.motion->clips[0].last, 3.0);
}

TEST_F(GltfMotion, StepsHoldTheKeyBefore) {
  GltfFile file = triangle();
  SceneDescription scene = good_gltf(file.text(moving(
      {{of_node(0, "translation"), vectors(file, {0, 1, 2}, {0, 0, 0, 1, 0, 0, 2, 0, 0}, "STEP")},
       {of_node(0, "rotation"), keys<float>(file, {0, 1}, "VEC4", 4, {0, 0, 0, 1, 0, 0, 1, 0}, "STEP")},
       {of_node(0, "scale"), vectors(file, {0, 1.5f}, {1, 1, 1, 3, 3, 3}, "STEP")}})));
  expect_near(vertex(scene, 0.999, 1), {1, 0, 0});
  expect_near(vertex(scene, 1, 1), {0, 0, 0});  // 1 - 1
  expect_near(vertex(scene, 1.5, 1), {1 - 3, 0, 0});
  expect_near(vertex(scene, 2, 1), {2 - 3, 0, 0});
}

/// t³ - 2 t² + t + 1 and its derivative: a Hermite spline reproduces cubic polynomials.
double cubic(double t) { return t * t * t - 2 * t * t + t + 1; }
double slope(double t) { return 3 * t * t - 4 * t + 1; }

std::vector<float> spline_keys(const std::vector<float>& times, std::size_t components, std::size_t moving) {
  std::vector<float> numbers;
  for (const float t : times)
    for (const double value : {slope(t), cubic(t), slope(t)})
      for (std::size_t c = 0; c < components; ++c) numbers.push_back(c == moving ? float(value) : 0.0f);
  return numbers;
}

TEST_F(GltfMotion, CubicSplinesReproduceCubicPolynomials) {
  GltfFile file = triangle();
  const std::vector<float> times = {0, 2, 3};
  std::vector<float> scales = spline_keys(times, 3, 0);
  for (std::size_t key = 0; key < times.size(); ++key) scales[key * 9 + 4] = scales[key * 9 + 5] = 1.0f;
  SceneDescription scene = good_gltf(file.text(
      moving({{of_node(0, "translation"), vectors(file, times, spline_keys(times, 3, 2), "CUBICSPLINE")},
              {of_node(0, "scale"), vectors(file, times, scales, "CUBICSPLINE")}})));
  for (const double t : {0.0, 0.25, 1.0, 1.9, 2.0, 2.5, 2.99, 3.0})
    expect_near(vertex(scene, t, 1), {cubic(t), 0, cubic(t)}, 1e-12);
  expect_near(vertex(scene, 4, 1), {cubic(3), 0, cubic(3)}, 1e-12);
}

TEST_F(GltfMotion, LinearRotationsTakeTheShorterArcAtEvenSpeed) {
  const float s = std::sqrt(0.5f);
  // The second key is -q of a quarter turn.
  GltfFile file = triangle();
  SceneDescription scene = good_gltf(file.text(
      moving({{of_node(0, "rotation"), keys<float>(file, {0, 2}, "VEC4", 4, {0, 0, 0, 1, 0, 0, -s, -s})}})));
  for (const double t : {0.0, 0.3, 1.0, 1.7, 2.0}) {
    const double angle = t / 2 * std::numbers::pi / 2;
    expect_near(vertex(scene, t, 1), {std::cos(angle), std::sin(angle), 0});
  }
}

TEST_F(GltfMotion, CubicSplinesOfRotationsAreNormalised) {
  GltfFile file = triangle();
  SceneDescription scene = good_gltf(file.text(moving(
      {{of_node(0, "rotation"), keys<float>(file, {0, 1}, "VEC4", 4, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0,
                                                                      0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0},
                                            "CUBICSPLINE")}})));
  for (const double t : {0.0, 0.25, 0.5, 0.8, 1.0}) {
    const double s = t * t * (3 - 2 * t), angle = 2 * std::atan2(s, 1 - s);
    expect_near(vertex(scene, t, 1), {std::cos(angle), std::sin(angle), 0});
  }
}

TEST_F(GltfMotion, NormalisedIntegersAreRotationsAndWeights) {
  GltfFile file = triangle();
  file.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  SceneDescription scene = good_gltf(file.text(one_mesh(
      R"({"attributes": {"POSITION": 0}, "targets": [{"POSITION": 2}]})",
      fmt::format(
          R"(, "animations": [{}])",
          clip({{of_node(0, "rotation"),
                 keys<std::int16_t>(file, {0, 1}, "VEC4", 4, {0, 0, 0, 32767, 0, 0, 23170, 23170}, "LINEAR",
                                    R"(, "normalized": true)")},
                {of_node(0, "weights"), keys<std::uint8_t>(file, {0, 1}, "SCALAR", 1, {0, 255}, "LINEAR",
                                                           R"(, "normalized": true)")}})))));
  expect_near(vertex(scene, 1, 1), {0, 1, 1});
  const double s = std::sqrt(0.5);
  expect_near(vertex(scene, 0.5, 1), {s, s, 0.5});
}

TEST_F(GltfMotion, WeightsOfAllInterpolations) {
  // Target 0 moves along x, target 1 along y, and turns the normal.
  GltfFile file = triangle();
  file.accessor<float>("VEC3", {1, 0, 0, 1, 0, 0, 1, 0, 0}, 3);
  file.accessor<float>("VEC3", {0, 1, 0, 0, 1, 0, 0, 1, 0}, 3);
  file.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  file.accessor<float>("VEC3", {1, 0, 0, 1, 0, 0, 1, 0, 0}, 3);
  const auto weighted = [&](std::string_view keys) {
    return good_gltf(file.text(one_mesh(
        R"({"attributes": {"POSITION": 0, "NORMAL": 4}, "targets": [{"POSITION": 2}, {"POSITION": 3, "NORMAL": 5}]})",
        fmt::format(R"(, "animations": [{}])", clip({{of_node(0, "weights"), std::string(keys)}})),
        R"(, "weights": [9, 9])")));
  };
  SceneDescription linear = weighted(keys<float>(file, {0, 2}, "SCALAR", 1, {0, 1, 4, 3}));
  expect_near(vertex(linear, 0.5, 0), {1, 1.5, 0}, 1e-12);
  show(linear, 2);
  const glm::dvec3 normal(mesh(linear).normals.at(0));
  expect_near(normal, glm::normalize(glm::dvec3(3, 0, 1)));
  SceneDescription step = weighted(keys<float>(file, {0, 2}, "SCALAR", 1, {0, 1, 4, 3}, "STEP"));
  expect_near(vertex(step, 1.9, 0), {0, 1, 0}, 0.0);
  const std::vector<float> times = {0, 2, 3};
  SceneDescription spline =
      weighted(keys<float>(file, times, "SCALAR", 1, spline_keys(times, 2, 1), "CUBICSPLINE"));
  for (const double t : {0.0, 0.5, 1.5, 2.25, 3.0})
    expect_near(vertex(spline, t, 0), {0, cubic(t), 0}, 1e-12);
}

TEST_F(GltfMotion, OneKeyIsAPoseAndNotMotion) {
  GltfFile file = triangle();
  const SceneDescription scene =
      good_gltf(file.text(moving({{of_node(0, "translation"), vectors(file, {0.5f}, {7, 0, 0})},
                                  {of_node(0, "scale"), vectors(file, {0, 1}, {2, 2, 2, 2, 2, 2})}},
                                 R"(, "translation": [1, 1, 1])")));
  EXPECT_EQ(scene.motion, nullptr);
  expect_near(mesh(scene).positions[1], {9, 0, 0}, 0.0);
  EXPECT_THAT(warnings(scene), HasSubstr("the animation '0' moves nothing that is shown"));
}

TEST_F(GltfMotion, KeysAlmostEqualInTimeAreAStep) {
  GltfFile file = triangle();
  const float next = std::nextafter(1.0f, 2.0f);
  SceneDescription scene = good_gltf(file.text(moving(
      {{of_node(0, "translation"), vectors(file, {0, 1, next, 2}, {0, 0, 0, 1, 0, 0, 5, 0, 0, 6, 0, 0})}})));
  expect_near(vertex(scene, 1, 0), {1, 0, 0}, 0.0);
  expect_near(vertex(scene, next, 0), {5, 0, 0}, 0.0);
  expect_near(vertex(scene, 0.5 + 0.5 * next, 0), {3, 0, 0});
}

TEST_F(GltfMotion, ClipsAreChosenByNameOrNumber) {
  GltfFile file = triangle();
  const std::string walk = vectors(file, {0, 1}, {0, 0, 0, 1, 0, 0}),
                    run = vectors(file, {0, 4}, {0, 0, 0, 0, 9, 0}),
                    grow = vectors(file, {0, 4}, {1, 1, 1, 2, 2, 2});
  const std::string text = file.text(one_mesh(
      kTriangle,
      fmt::format(R"(, "animations": [{}, {}, {}])", clip({{of_node(0, "translation"), walk}}, "walk"),
                  clip({{of_node(0, "translation"), run}}, "run"), clip({{of_node(0, "scale"), grow}}))));
  SceneDescription first = good_gltf(text);
  EXPECT_THAT(warnings(first),
              HasSubstr("of 3 animations 2 are shown, 'walk' and those that change nothing that is changed "
                        "already; --clip NAME shows one: walk, run, 2"));
  expect_near(vertex(first, 1, 0), {1, 0, 0}, 0.0);
  ASSERT_EQ(first.motion->clips.size(), 3u);
  EXPECT_TRUE(first.motion->clips[0].is_shown);
  EXPECT_FALSE(first.motion->clips[1].is_shown);
  EXPECT_TRUE(first.motion->clips[2].is_shown) << "it changes the scale alone";
  EXPECT_EQ(first.motion->clips[1].last, 4.0);
  for (const char* name : {"run", "1"}) {
    SceneDescription other = good_gltf(text, {.clip = name});
    EXPECT_THAT(warnings(other), Not(HasSubstr("3 animations")));
    expect_near(vertex(other, 4, 0), {0, 9, 0}, 0.0);
    EXPECT_TRUE(other.motion->clips[1].is_shown);
    EXPECT_FALSE(other.motion->clips[0].is_shown);
  }
  EXPECT_EQ(good_gltf(text, {.clip = "2"}).motion->clips[2].is_shown, true);
  EXPECT_THAT(
      gltf_error(text, {.clip = "runs"}),
      AllOf(HasSubstr("scene.gltf:"), HasSubstr("there is no animation 'runs'; did you mean 'run'? The file "
                                                "has: walk, run, 2")));
  EXPECT_THAT(gltf_error(triangle().text(one_mesh(kTriangle)), {.clip = "walk"}),
              HasSubstr("the file has no animations, so no clip 'walk'"));
}

TEST_F(GltfMotion, WhatIsBelowAMovingNodeMovesAndNothingElse) {
  // 0: fixed; 1: turns; 2: below it, with a mesh; 3: a fixed mesh.
  GltfFile file = triangle();
  const std::string quarter =
      keys<float>(file, {0, 1}, "VEC4", 4, {0, 0, 0, 1, 0, 0, std::sqrt(0.5f), std::sqrt(0.5f)});
  const auto text = [&](std::string_view animations) {
    return file.text(fmt::format(
        R"("scenes": [{{"nodes": [0, 3]}}], "nodes": [{{"children": [1], "translation": [0, 0, 5]}}, {{"children": [2]}},
{{"mesh": 0, "translation": [2, 0, 0]}}, {{"mesh": 0, "rotation": [0.1, 0.2, 0.3, 0.4], "scale": [-1, 2, 3]}}],
"meshes": [{{"primitives": [{}]}}]{})",
        kTriangle, animations));
  };
  SceneDescription scene =
      good_gltf(text(fmt::format(R"(, "animations": [{}])", clip({{of_node(1, "rotation"), quarter}}))));
  const SceneDescription still = good_gltf(text(""));
  expect_near(vertex(scene, 1, 0), {0, 2, 5});
  EXPECT_EQ(moving_shapes(scene), std::vector<bool>({true, false}));
  EXPECT_EQ(mesh(scene, 1).positions, mesh(still, 1).positions);
  EXPECT_EQ(mesh(scene, 1).triangles, mesh(still, 1).triangles);
}

TEST_F(GltfMotion, WhatIsScaledToNothingVanishesAndReturns) {
  GltfFile file = triangle();
  SceneDescription scene = good_gltf(file.text(
      moving({{of_node(0, "scale"), vectors(file, {0, 1, 2}, {0, 0, 0, 1, 1, 1, 1e-12f, 1e-12f, 1e-12f})}})));
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_TRUE(mesh(scene).triangles.empty());
  expect_near(vertex(scene, 0.5, 1), {0.5, 0, 0});
  EXPECT_EQ(mesh(scene).triangles.size(), 1u);
  show(scene, 2);
  EXPECT_TRUE(mesh(scene).triangles.empty());
  expect_near(vertex(scene, 1, 1), {1, 0, 0});
}

TEST_F(GltfMotion, FlattenedAlongOneAxisIsAsAtRest) {
  GltfFile file;
  file.accessor<float>("VEC3", {0, 0, 0, 1, 0, 1, 0, 1, 2}, 3);
  file.accessor<float>("VEC3", {1, 0, 0, 1, 0, 0, 1, 0, 0}, 3);
  const char* primitive = R"({"attributes": {"POSITION": 0, "NORMAL": 1}})";
  const std::string flatten = vectors(file, {0, 1}, {1, 1, 1, 2, 2, 0});
  SceneDescription scene = good_gltf(file.text(
      one_mesh(primitive, fmt::format(R"(, "animations": [{}])", clip({{of_node(0, "scale"), flatten}})))));
  const SceneDescription still = good_gltf(file.text(one_mesh(primitive, "", R"(, "scale": [2, 2, 0])")));
  show(scene, 1);
  EXPECT_EQ(mesh(scene).positions, mesh(still).positions);
  EXPECT_TRUE(mesh(scene).normals.empty());
  EXPECT_EQ(mesh(scene).triangles, mesh(still).triangles);
}

TEST_F(GltfMotion, MirroredPosesKeepTheFrontAsAtRest) {
  GltfFile file = triangle();
  const std::string mirror = vectors(file, {0, 1}, {1, 1, 1, -1, 1, 1});
  SceneDescription scene = good_gltf(file.text(moving({{of_node(0, "scale"), mirror}})));
  const SceneDescription still =
      good_gltf(triangle().text(one_mesh(kTriangle, "", R"(, "scale": [-1, 1, 1])")));
  show(scene, 1);
  EXPECT_EQ(mesh(scene).positions, mesh(still).positions);
  EXPECT_EQ(mesh(scene).triangles, mesh(still).triangles);
}

TEST_F(GltfMotion, InstancesOfAMovingNodeMove) {
  GltfFile file = triangle();
  const int offsets = file.accessor<float>("VEC3", {0, 0, 0, 0, 0, 4}, 2);
  SceneDescription scene = good_gltf(file.text(moving(
      {{of_node(0, "scale"), vectors(file, {0, 1, 2}, {1, 1, 1, 2, 2, 2, 0, 0, 0})}},
      fmt::format(R"(, "extensions": {{"EXT_mesh_gpu_instancing": {{"attributes": {{"TRANSLATION": {}}}}}}})",
                  offsets))));
  ASSERT_EQ(scene.instances.size(), 2u);
  show(scene, 1);
  expect_near(glm::dvec3(scene.instances[1].to_world[3]), {0, 0, 8}, 0.0);
  EXPECT_EQ(moving_instances(scene), std::vector<bool>({true, true}));
  show(scene, 2);
  EXPECT_TRUE(scene.instances[0].hidden);
  show(scene, 0);
  EXPECT_FALSE(scene.instances[0].hidden);
}

TEST_F(GltfMotion, EmissionMovesAlong) {
  GltfFile file = triangle();
  const SceneDescription scene = good_gltf(file.text(
      one_mesh(R"({"attributes": {"POSITION": 0}, "material": 0})",
               fmt::format(R"(, "materials": [{{"emissiveFactor": [1, 0.5, 0]}}], "animations": [{}])",
                           clip({{of_node(0, "translation"), vectors(file, {0, 1}, {0, 0, 0, 1, 0, 0})}})))));
  EXPECT_EQ(moving_shapes(scene), std::vector<bool>({true}));
  EXPECT_EQ(scene.shapes.at(0).radiance, glm::vec3(1, 0.5f, 0));
}

TEST_F(GltfMotion, ASceneWithoutACameraIsSeenWholeAtAllTimes) {
  // From (0, 0, 0) to (100, 1, 0): the camera sees the whole way, and stays.
  GltfFile file = triangle();
  SceneDescription scene = good_gltf(
      file.text(moving({{of_node(0, "translation"), vectors(file, {0, 1}, {0, 0, 0, 100, 0, 0})}})));
  const glm::dmat4 view = scene.camera.to_world;
  const double distance = glm::distance(glm::dvec3(view[3]), glm::dvec3(50.5, 0.5, 0));
  EXPECT_GT(distance * std::sin(20.0 * std::numbers::pi / 180), 50.0);
  show(scene, 1);
  EXPECT_EQ(scene.camera.to_world, view);
}

// --- Skins ---

TEST_F(GltfMotion, SkinsFollowTheirJointsAndNotTheirNode) {
  // Joint 1 grows, joint 2 is above it by 1 and turns by a quarter. The mesh's own node is moved far away.
  GltfFile file;
  file.accessor<float>("VEC3", {0, 0, 0, 0, 2, 0, 1, 2, 0}, 3);
  file.accessor<std::uint8_t>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, 3);
  file.accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}, 3);
  file.accessor<float>(
      "MAT4",
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1}, 2);
  const float s = std::sqrt(0.5f);
  const std::string scale = vectors(file, {0, 1}, {1, 1, 1, 3, 3, 3}),
                    turn = keys<float>(file, {0, 1}, "VEC4", 4, {0, 0, 0, 1, 0, 0, s, s});
  SceneDescription scene = good_gltf(file.text(fmt::format(
      R"("scenes": [{{"nodes": [0, 1]}}], "nodes": [{{"mesh": 0, "skin": 0, "translation": [50, 0, 0], "scale": [0, 0, 0]}},
{{"children": [2]}}, {{"translation": [0, 1, 0]}}], "skins": [{{"joints": [1, 2], "inverseBindMatrices": 3}}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}}}}]}}],
"animations": [{}])",
      clip({{of_node(1, "scale"), scale},
            {of_node(2, "rotation"), turn},
            {of_node(0, "translation"), scale}}))));
  expect_near(vertex(scene, 0, 1), {0, 2, 0});
  for (const double t : {0.25, 0.5, 1.0}) {
    const double size = 1 + 2 * t, angle = t * std::numbers::pi / 2;
    // Of joint 2: (x, y) about (0, 1), turned.
    const auto turned = [&](double x, double y) {
      return glm::dvec3(x * std::cos(angle) - (y - 1) * std::sin(angle),
                        1 + x * std::sin(angle) + (y - 1) * std::cos(angle), 0);
    };
    expect_near(vertex(scene, t, 0), {0, 0, 0});
    expect_near(vertex(scene, t, 1), size * turned(0, 2), 3 * kSingle);
    expect_near(vertex(scene, t, 2), size * 0.5 * (glm::dvec3(1, 2, 0) + turned(1, 2)), 3 * kSingle);
  }
  EXPECT_EQ(scene.motion->nodes.size(), 2u) << "the joints alone";
}

// --- Visibility ---

TEST_F(GltfMotion, VisibilityHidesWhatIsBelow) {
  GltfFile file = triangle();
  const std::string shown = keys<std::uint8_t>(file, {0, 1, 2}, "SCALAR", 1, {0, 1, 0}, "STEP");
  SceneDescription scene = good_gltf(file.text(fmt::format(
      R"("scenes": [{{"nodes": [0, 2]}}], "nodes": [{{"children": [1]}}, {{"mesh": 0, "translation": [3, 0, 0],
"extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}}, {{"mesh": 0}}],
"extensions": {{"KHR_lights_punctual": {{"lights": [{{"type": "point", "intensity": 683}}]}}}},
"meshes": [{{"primitives": [{}]}}], "animations": [{}])",
      kTriangle, clip({{of_pointer("/nodes/0/extensions/KHR_node_visibility/visible"), shown}}))));
  EXPECT_TRUE(mesh(scene, 0).triangles.empty());
  EXPECT_EQ(mesh(scene, 1).triangles.size(), 1u);
  EXPECT_EQ(only<PointLight>(scene).intensity, glm::vec3(0.0f));
  expect_near(vertex(scene, 1, 1, 0), {4, 0, 0}, 0.0);
  EXPECT_NEAR(only<PointLight>(scene).intensity.x, 1.0, kSingle);
  expect_near(only<PointLight>(scene).position, {3, 0, 0}, 0.0);
  show(scene, 2);
  EXPECT_TRUE(mesh(scene, 0).triangles.empty());
}

}  // namespace
}  // namespace penumbra
