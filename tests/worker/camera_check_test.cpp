// Cameras that arrive over the network: a worker refuses invalid values.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "kernels/features.h"
#include "kernels/host/device_scene.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInfinite = std::numeric_limits<float>::infinity();

/// A lens with blades, a distortion and channels apart.
DeviceScene lens_scene() {
  SceneDescription scene = read_or_throw(project_file("scenes/cornell-small/cornell-small.xml"));
  scene.camera.aperture_radius = 0.1;
  scene.camera.blades = 6;
  scene.camera.distortion_k1 = 0.05;
  scene.camera.principal_point_offset_x = 0.1;
  scene.camera.magnify_red = 0.01;
  return build_or_throw(scene);
}

struct Broken {
  const char* what;  ///< in the error
  std::function<void(Camera&)> change;
};

TEST(CameraCheck, ALensAsItIsBuiltIsAccepted) {
  const DeviceScene scene = lens_scene();
  ASSERT_NE(scene.header.features & FEATURE_CAMERA, 0u);
  const auto checked = check_device_scene(scene);
  EXPECT_TRUE(checked) << checked.error().message;
}

TEST(CameraCheck, NumbersThatNoLensHasAreRefused) {
  const std::vector<Broken> broken = {{"implausible lens", [](Camera& c) { c.lens_radius = kNan; }},
                                      {"implausible lens", [](Camera& c) { c.lens_radius = -0.1f; }},
                                      {"implausible lens", [](Camera& c) { c.lens_radius = kInfinite; }},
                                      {"implausible lens", [](Camera& c) { c.focus.y = kNan; }},
                                      {"implausible lens", [](Camera& c) { c.focus.x = 0.0f; }},
                                      {"implausible lens", [](Camera& c) { c.focus.z = -1.0f; }},
                                      {"implausible lens", [](Camera& c) { c.image_scale.z = kNan; }},
                                      {"implausible lens", [](Camera& c) { c.image_scale.x = 0.0f; }},
                                      {"implausible lens", [](Camera& c) { c.image_scale.y = kInfinite; }},
                                      {"implausible blades", [](Camera& c) { c.blades = kNan; }},
                                      {"implausible blades", [](Camera& c) { c.blades = 1025.0f; }},
                                      {"implausible blades", [](Camera& c) { c.blades = -1.0f; }},
                                      {"implausible blades", [](Camera& c) { c.blades = 5.5f; }},
                                      {"implausible blades", [](Camera& c) { c.blades = 2.0f; }},
                                      {"implausible blades", [](Camera& c) { c.blade_turn = kNan; }},
                                      {"implausible blades", [](Camera& c) { c.blade_turn = 1.5f; }},
                                      {"implausible distortion", [](Camera& c) { c.reach = kNan; }},
                                      {"implausible distortion", [](Camera& c) { c.reach = -1.0f; }},
                                      {"implausible distortion", [](Camera& c) { c.reach = kInfinite; }},
                                      {"implausible distortion", [](Camera& c) { c.k1 = kNan; }},
                                      {"implausible distortion", [](Camera& c) { c.k2 = kInfinite; }},
                                      {"axis beside", [](Camera& c) { c.offset_x = kNan; }},
                                      {"axis beside", [](Camera& c) { c.offset_y = kInfinite; }},
                                      {"unknown kind", [](Camera& c) { c.parallel = kNan; }},
                                      {"unknown kind", [](Camera& c) { c.parallel = 0.5f; }},
                                      {"unknown kind", [](Camera& c) { c.split = 2.0f; }}};
  const DeviceScene good = lens_scene();
  for (std::size_t i = 0; i < broken.size(); ++i) {
    DeviceScene scene = good;
    broken[i].change(scene.header.camera);
    const auto checked = check_device_scene(scene);
    ASSERT_FALSE(checked) << "case " << i << " should be refused as " << broken[i].what;
    EXPECT_NE(checked.error().message.find(broken[i].what), std::string::npos)
        << "case " << i << ": " << checked.error().message;
    // The same over the wire.
    EXPECT_FALSE(DeviceScene::deserialize(scene.serialize())) << "case " << i;
  }
}

TEST(CameraCheck, NumbersThatNoPanoramaHasAreRefused) {
  SceneDescription description = read_or_throw(project_file("scenes/cornell-small/cornell-small.xml"));
  description.camera.projection = Projection::kEquirectangular;
  description.camera.stereo = StereoPair::kTopBottom;
  const DeviceScene good = build_or_throw(description);
  const auto accepted = check_device_scene(good);
  ASSERT_TRUE(accepted) << accepted.error().message;
  const std::vector<Broken> broken = {
      {"unknown panorama", [](Camera& c) { c.panorama = 1.5f; }},
      {"unknown panorama", [](Camera& c) { c.panorama = 6.0f; }},
      {"without its feature bit", [](Camera& c) { c.panorama = 0.0f; }},
      {"implausible panorama", [](Camera& c) { c.half_x = 0.0f; }},
      {"implausible panorama", [](Camera& c) { c.half_y = kNan; }},
      {"implausible panorama", [](Camera& c) { c.center_x = kInfinite; }},
      {"implausible panorama", [](Camera& c) { c.limit = -1.0f; }},
      {"implausible panorama", [](Camera& c) { c.eye = -0.1f; }},
      {"implausible panorama", [](Camera& c) { c.half_x = 0.6f; }},
      {"implausible panorama", [](Camera& c) { c.half_y = 0.26f; }},
      {"implausible panorama", [](Camera& c) { c.center_y = 0.1f; }},
      {"implausible panorama", [](Camera& c) { c.center_x = 1e9f; }},
      {"implausible panorama", [](Camera& c) { c.pictures = 1.0f; }},
      {"no pair of pictures", [](Camera& c) { c.pictures = 3.0f; }},
      {"no pair of pictures", [](Camera& c) { c.panorama = float(PANORAMA_CYLINDRICAL); }}};
  for (const auto& [what, change] : broken) {
    DeviceScene scene = good;
    change(scene.header.camera);
    const auto checked = check_device_scene(scene);
    ASSERT_FALSE(checked) << what;
    EXPECT_NE(checked.error().message.find(what), std::string::npos) << checked.error().message;
  }
}

TEST(CameraCheck, ALensNeedsItsFeature) {
  DeviceScene scene = lens_scene();
  scene.header.features &= ~std::uint64_t(FEATURE_CAMERA);
  const auto checked = check_device_scene(scene);
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().message.find("without its feature bit"), std::string::npos);
  // Numbers that are no numbers are no plain camera's.
  for (float Camera::*member : {&Camera::lens_radius, &Camera::offset_x, &Camera::offset_y, &Camera::reach,
                                &Camera::split, &Camera::parallel}) {
    DeviceScene plain = build_or_throw(read_or_throw(project_file("scenes/cornell-small/cornell-small.xml")));
    plain.header.camera.*member = kNan;
    EXPECT_FALSE(check_device_scene(plain));
  }
}

}  // namespace
}  // namespace penumbra
