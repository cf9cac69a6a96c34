// Poses of an animated glTF file that Blender exported, against those that Blender shows: a parent that
// mirrors, morph targets, a skin whose lowest bone grows, a camera that zooms, a spot. All are keyed by
// KHR_animation_pointer.
#include <algorithm>
#include <filesystem>
#include <numbers>

#include "tests/scenes/gltf_motion.h"

namespace penumbra {
namespace {

#include "tests/scenes/gltf_animated.inc"

constexpr double kRate = 24.0;
/// Blender evaluates in single precision: some roundings of 2^-24 each, of coordinates up to 10.
constexpr double kBlender = 1e-5;

TEST(GltfPoses, AreThoseOfBlender) {
  const auto file = std::filesystem::path(PENUMBRA_SOURCE_DIR) / "tests/scenes/animated.glb";
  auto scene = read_scene(file, {.time = 0.0});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->shapes.size(), 3u);
  const auto range = time_range(*scene->motion);
  ASSERT_TRUE(range);
  EXPECT_EQ(range->first, 0.0);
  EXPECT_EQ(range->second, 1.0);
  for (const Reach& expected : kReaches) {
    ASSERT_TRUE(set_time(*scene, expected.frame / kRate));
    const auto shape = std::ranges::find(scene->shapes, expected.mesh, &Shape::name);
    ASSERT_NE(shape, scene->shapes.end()) << expected.mesh;
    for (std::size_t d = 0; d < std::size(kDirections); ++d) {
      double reach = -1e30;
      for (const glm::dvec3& p : std::get<Mesh>(shape->geometry).positions)
        reach =
            std::max(reach, glm::dot(p, glm::dvec3(kDirections[d][0], kDirections[d][1], kDirections[d][2])));
      EXPECT_NEAR(reach, expected.reach[d], kBlender) << expected.mesh << ", frame " << expected.frame;
    }
  }
}

TEST(GltfPoses, ViewsAreThoseOfBlender) {
  const auto file = std::filesystem::path(PENUMBRA_SOURCE_DIR) / "tests/scenes/animated.glb";
  auto scene = read_scene(file, {.time = 0.0});
  ASSERT_TRUE(scene) << scene.error().message;
  for (const auto& expected : kViews) {
    ASSERT_TRUE(set_time(*scene, expected[0] / kRate));
    const auto expect = [&](const glm::dvec4& ours, const double* theirs, const char* what) {
      EXPECT_LE(glm::distance(glm::dvec3(ours), glm::dvec3(theirs[0], theirs[1], theirs[2])), kBlender)
          << what << ", frame " << expected[0];
    };
    const CameraSettings& camera = scene->camera;
    EXPECT_NEAR(camera.fov, expected[1], kBlender);
    expect(camera.to_world[3], expected + 2, "eye");
    expect(camera.to_world[2], expected + 5, "view");
    expect(camera.to_world[1], expected + 8, "up");
    const auto& spot = only<SpotLight>(*scene);
    expect(spot.to_world[3], expected + 11, "light");
    expect(spot.to_world[2], expected + 14, "beam");
  }
}

}  // namespace
}  // namespace penumbra
