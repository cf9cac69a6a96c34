#include "gl/camera_text.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "gl/camera_control.h"
#include "scenes/settings.h"

namespace penumbra {
namespace {

Camera camera_at(const glm::dvec3& eye, const glm::dvec3& at, float half_height, bool is_mirrored) {
  SceneHeader header{};
  header.camera.x = {is_mirrored ? -1.5f * half_height : 1.5f * half_height, 0, 0};
  header.camera.y = {0, half_height, 0};
  header.camera.z = {0, 0, 1};
  set_camera({eye, at, {0, 1, 0}}, header);
  return header.camera;
}

TEST(CameraText, SaysWhereTheCameraIs) {
  const Camera camera = camera_at({1, 2, 3}, {1, 2, -1}, 0.5f, false);
  EXPECT_EQ(camera_text(camera, {0, 0, 0}, 4, CameraFormat::kSettings), "camera.lookat=1 2 3 1 2 -1 0 1 0");
  EXPECT_EQ(camera_text(camera, {10, 0, 0}, 4, CameraFormat::kTinyRender),
            "[camera]\neye = [11, 2, 3]\nat = [11, 2, -1]\nup = [0, 1, 0]\nfov = 53.1301024\n");
  EXPECT_EQ(camera_text(camera, {0, 0, 0}, 4, CameraFormat::kMitsuba),
            "<transform name=\"to_world\">\n"
            "  <lookat origin=\"1, 2, 3\" target=\"1, 2, -1\" up=\"0, 1, 0\"/>\n"
            "</transform>\n"
            "<string name=\"fov_axis\" value=\"y\"/>\n"
            "<float name=\"fov\" value=\"53.1301024\"/>\n");
}

/// The setting is taken, and gives the same axes: for a mirrored film as well.
TEST(CameraText, ASettingGivesTheSameAxes) {
  for (const bool is_mirrored : {false, true}) {
    const Camera camera = camera_at({-3, 1.25, 7.5}, {0.5, 0.25, 0}, 0.3f, is_mirrored);
    const std::string text = camera_text(camera, {100, 0, 0}, 2, CameraFormat::kSettings);
    RenderSettings settings;
    const auto applied =
        apply_setting(settings, text.substr(0, text.find('=')), text.substr(text.find('=') + 1));
    ASSERT_TRUE(applied.has_value()) << text << ": " << applied.error().message;
    const glm::dmat4& matrix = settings.camera.to_world;
    const vec3 axes[] = {camera.x, camera.y, camera.z};
    for (int column = 0; column < 3; ++column) {
      const glm::dvec3 axis = glm::normalize(glm::dvec3(axes[column].x, axes[column].y, axes[column].z));
      for (int row = 0; row < 3; ++row) EXPECT_NEAR(matrix[column][row], axis[row], 1e-6) << text;
    }
    EXPECT_NEAR(matrix[3][0], 97, 1e-5);
  }
}

}  // namespace
}  // namespace penumbra
