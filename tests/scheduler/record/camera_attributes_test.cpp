// Compares the camera matrices in an image's attributes with rays of the camera that rendered it.
#include "scheduler/record/camera_attributes.h"

#include <gtest/gtest.h>

#include <random>

#include "kernels/camera/lens_camera.h"
#include "scenes/device/camera_builder.h"
#include "scenes/transform.h"

namespace penumbra {
namespace {

glm::dvec4 times(const glm::dvec3& point, const RowMatrix& m) {
  const double row[4] = {point.x, point.y, point.z, 1};
  glm::dvec4 result(0);
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 4; ++i) result[k] += row[i] * double(m[std::size_t(4 * i + k)]);
  return result;
}

struct Tested {
  std::string name;
  CameraSettings camera;
};
void PrintTo(const Tested& tested, std::ostream* out) { *out << tested.name; }

CameraSettings camera_at(glm::dvec3 origin, glm::dvec3 target, bool mirrored = false) {
  CameraSettings camera;
  camera.to_world = *look_at(origin, target, glm::dvec3(0.1, 1, 0.3));
  if (mirrored) camera.to_world[0] = -camera.to_world[0];
  camera.fov = 70;
  camera.near_clip = 0.5;
  camera.far_clip = 40;
  return camera;
}

std::vector<Tested> cameras() {
  std::vector<Tested> all{{"Pinhole", camera_at({3, 2, -5}, {0, 1, 0})},
                          {"Mirrored", camera_at({3, 2, -5}, {0, 1, 0}, true)},
                          {"Shifted", camera_at({-2, 4, 1}, {5, 0, 0})},
                          {"Orthographic", camera_at({1, 7, 2}, {0, 0, 0.5})},
                          {"Magnified", camera_at({1, 7, 2}, {0, 0, 0.5})}};
  all[2].camera.principal_point_offset_x = 0.2;
  all[2].camera.principal_point_offset_y = -0.1;
  all[3].camera.projection = Projection::kOrthographic;
  all[3].camera.scale_x = 3;
  all[3].camera.scale_y = 2;
  all[3].camera.principal_point_offset_x = 0.2;
  all[4].camera.magnify_green = 0.05;
  return all;
}

class CameraAttributes : public testing::TestWithParam<Tested> {};
INSTANTIATE_TEST_SUITE_P(All, CameraAttributes, testing::ValuesIn(cameras()),
                         [](const auto& tested) { return tested.param.name; });

/// Channel 1 is green, whose layers are in the image; the lens point is its centre.
Ray ray_through(const CameraSettings& settings, const Film& film, int x, int y, float dx, float dy) {
  const glm::dvec3 origin(settings.to_world[3]);
  const Camera camera =
      build_camera(settings, film, make_vec3(float(origin.x), float(origin.y), float(origin.z)));
  FilmParameters parameters{};
  parameters.width = film.width;
  parameters.height = film.height;
  if (camera_features(settings) == 0) return camera_ray(camera, parameters, x, y, dx, dy);
  const FilmPoint p = film_point(camera, parameters, channel_of(camera.image_scale, 1), x, y, dx, dy);
  return lens_ray(camera, channel_of(camera.focus, 1), p.x, p.y, 0, 0);
}

TEST_P(CameraAttributes, ProjectWhatARaySeesToItsPointOfTheFilm) {
  const CameraSettings& camera = GetParam().camera;
  const Film film{.width = 64, .height = 40, .crop_width = 64, .crop_height = 40};
  const ImageCamera attributes = camera_attributes(camera, film);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int k = 0; k < 1000; ++k) {
    const int x = int(uniform(random) * 64), y = int(uniform(random) * 40);
    const float dx = uniform(random) - 0.5f, dy = uniform(random) - 0.5f;
    const Ray ray = ray_through(camera, film, x, y, dx, dy);
    const double t = double(uniform(random)) * double(ray.tmax);
    const auto exact = [](vec3 v) { return glm::dvec3(v.x, v.y, v.z); };
    const glm::dvec3 point = exact(ray.origin) + t * exact(ray.direction);
    // Some 20 roundings of coordinates up to 50 in units of the film, which is at least 0.5 wide at the near
    // plane.
    constexpr double kTolerance = 20 * 0x1p-24 * 50 / 0.5;
    const glm::dvec4 ndc = times(point, attributes.world_to_ndc.value());
    ASSERT_NEAR(ndc.x / ndc.w, (x + 0.5 + double(dx)) / 64, kTolerance);
    ASSERT_NEAR(ndc.y / ndc.w, (y + 0.5 + double(dy)) / 40, kTolerance);
    ASSERT_GE(ndc.z / ndc.w, -kTolerance);
    ASSERT_LE(ndc.z / ndc.w, 1 + kTolerance);

    const glm::dvec4 seen = times(point, attributes.world_to_camera);
    const glm::dvec3 from = point - glm::dvec3(camera.to_world[3]);
    ASSERT_NEAR(glm::length(glm::dvec3(seen)), glm::length(from), 1e-4);
    ASSERT_NEAR(seen.z, glm::dot(from, glm::dvec3(camera.to_world[2])), 1e-4) << "positive along the view";
    ASSERT_NEAR(seen.y, glm::dot(from, glm::dvec3(camera.to_world[1])), 1e-4) << "positive upwards";
    ASSERT_EQ(seen.w, 1);
  }
}

TEST_P(CameraAttributes, XIsToTheRightOfTheImage) {
  const CameraSettings& camera = GetParam().camera;
  const Film film{.width = 64, .height = 40, .crop_width = 64, .crop_height = 40};
  const ImageCamera attributes = camera_attributes(camera, film);
  const auto seen_x = [&](int x) {
    const Ray ray = ray_through(camera, film, x, 20, 0, 0);
    return times({ray.origin.x + ray.direction.x, ray.origin.y + ray.direction.y,
                  ray.origin.z + ray.direction.z},
                 attributes.world_to_camera)
        .x;
  };
  EXPECT_LT(seen_x(0), seen_x(63));
}

TEST(CameraAttributes, WithoutAFarPlaneAreFinite) {
  CameraSettings camera = camera_at({3, 2, -5}, {0, 1, 0});
  camera.far_clip = 3e38;
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic}) {
    camera.projection = projection;
    const ImageCamera attributes = camera_attributes(camera, {});
    for (const float value : attributes.world_to_ndc.value()) EXPECT_TRUE(std::isfinite(value));
  }
}

TEST(CameraAttributes, PanoramasHaveNoneToTheFilm) {
  CameraSettings camera = camera_at({3, 2, -5}, {0, 1, 0});
  const RowMatrix to_camera = camera_attributes(camera, {}).world_to_camera;
  camera.projection = Projection::kEquirectangular;
  EXPECT_EQ(camera_attributes(camera, {}).world_to_camera, to_camera);
  EXPECT_FALSE(camera_attributes(camera, {}).world_to_ndc);
}

}  // namespace
}  // namespace penumbra
