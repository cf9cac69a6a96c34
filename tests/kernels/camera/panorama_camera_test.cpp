// Panoramic cameras against their closed forms in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kernels/motion/motion_layer.h"
#include "scenes/device/camera_builder.h"
#include "scenes/device/to_vec3.h"
#include "scenes/panoramas.h"
#include "tests/kernels/kernels_under_test.h"
#include "tests/kernels/random_numbers.h"
#include "tests/support/panorama_directions.h"

namespace penumbra::panorama_camera_test {
namespace {

constexpr int kTrials = 2000;
// Some 30 roundings of numbers up to a turn.
constexpr double kRounding = 30 * 0x1p-24 * 2 * std::numbers::pi;

struct Shown {
  CameraSettings camera;
  Film film;
};

glm::dvec3 wide(const vec3& v) { return {v.x, v.y, v.z}; }

Shown random_panorama(RandomNumbers& random, Projection projection) {
  Shown s;
  s.film.width = s.film.crop_width = int(16 + random.below(400));
  s.film.height = s.film.crop_height = 2 * int(8 + random.below(200));
  CameraSettings& c = s.camera;
  c.projection = projection;
  c.longitude_min = random.between(-300, 100);
  c.longitude_max = c.longitude_min + random.between(10, 360);
  c.latitude_min = random.between(-90, 0);
  c.latitude_max = random.between(10, 90);
  c.height_min = random.between(-2, 0);
  c.height_max = random.between(0.1, 3);
  c.fisheye_fov = random.between(20, 360);
  c.fov_axis = FovAxis(random.below(5));
  c.fisheye_lens = random.between(5, 20);
  if (is_fisheye(projection)) {
    c.principal_point_offset_x = random.between(-0.2, 0.2);
    c.principal_point_offset_y = random.between(-0.2, 0.2);
  }
  c.near_clip = random.between(0.01, 0.3);
  const Exact3 z = random.direction(), x = normalize(cross(z, random.direction())), y = cross(z, x);
  const auto axis = [](const Exact3& v, double sign) {
    return glm::dvec4(sign * double(v.x), sign * double(v.y), sign * double(v.z), 0);
  };
  const double mirrored = random.below(2) == 0 ? 1 : -1;
  const Exact3 at = random.point(3);
  c.to_world = glm::dmat4(axis(x, mirrored), axis(y, 1), axis(z, 1), glm::dvec4(at.x, at.y, at.z, 1));
  return s;
}

Camera kernel_camera(const Shown& s) {
  return build_camera(s.camera, s.film, to_vec3(glm::dvec3(s.camera.to_world[3])));
}

FilmParameters film_of(const Shown& s) {
  FilmParameters film{};
  film.width = s.film.width;
  film.height = s.film.height;
  return film;
}

class Panoramas : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(Projections, Panoramas,
                         testing::Values(Projection::kEquirectangular, Projection::kCylindrical,
                                         Projection::kFisheyeEquidistant, Projection::kFisheyeEquisolid,
                                         Projection::kEqualArea),
                         [](const auto& tested) { return projection_name(tested.param); });

TEST_P(Panoramas, RaysHaveTheDirectionsOfTheirPixels) {
  RandomNumbers random(1);
  int seen = 0;
  for (int i = 0; i < kTrials; ++i) {
    const Shown s = random_panorama(random, GetParam());
    const Camera camera = kernel_camera(s);
    const int x = int(random.below(unsigned(s.film.width))), y = int(random.below(unsigned(s.film.height)));
    const double dx = random.between(-0.5, 0.5), dy = random.between(-0.5, 0.5);
    const auto exact =
        panorama_direction(s.camera, s.film, (x + 0.5 + dx) / s.film.width, (y + 0.5 + dy) / s.film.height);
    const PanoramaView view =
        panorama_view(camera, panorama_point(camera, film_of(s), x, y, float(dx), float(dy)));
    ASSERT_EQ(view.seen, exact.has_value());
    if (!exact) continue;
    ++seen;
    EXPECT_LT(glm::length(wide(view.direction) - *exact), kRounding);
    const Ray ray = panorama_ray(camera, camera.focus.x, view.direction, 0.0f, {0.0f, 0.0f});
    const glm::dmat3 axes(s.camera.to_world);
    EXPECT_LT(glm::length(wide(ray.direction) - axes * *exact), kRounding);
    // Clipping planes are spheres.
    EXPECT_NEAR(glm::length(wide(ray.origin) - glm::dvec3(s.camera.to_world[3])), s.camera.near_clip, 1e-5);
    EXPECT_NEAR(double(ray.tmax), s.camera.far_clip - s.camera.near_clip, 1e-2);
  }
  EXPECT_GT(seen, kTrials / 10);
}

/// From any direction to the film and back.
TEST_P(Panoramas, DirectionsAreWhereTheFilmShowsThem) {
  RandomNumbers random(2);
  int seen = 0;
  for (int i = 0; i < kTrials; ++i) {
    const Shown s = random_panorama(random, GetParam());
    const Camera camera = kernel_camera(s);
    const Exact3 way = random.direction();
    const glm::dvec3 direction(double(way.x), double(way.y), double(way.z));
    const vec3 world = to_vec3(glm::dmat3(s.camera.to_world) * (direction * random.between(0.5, 10)));
    const FilmPosition p = panorama_position(camera, film_of(s), world, random.below(2) == 0, 0);
    const double u = double(p.x) / s.film.width, v = double(p.y) / s.film.height;
    const bool fisheye = is_fisheye(GetParam());
    const double off = std::acos(std::clamp(direction.z, -1.0, 1.0)) * 180 / std::numbers::pi;
    if (std::abs(off - 0.5 * s.camera.fisheye_fov) < 1e-3) continue;
    ASSERT_EQ(p.seen, !fisheye || off < 0.5 * s.camera.fisheye_fov);
    if (!p.seen) continue;
    const auto back = panorama_direction(s.camera, s.film, u, v);
    if (!back) continue;
    ++seen;
    // Nearly opposite to a fisheye's axis half the angle's sine has half the digits.
    const double worse = GetParam() == Projection::kFisheyeEquisolid && off > 179 ? 100 : 4;
    // Positions far outside of the film are as accurate as they are large.
    EXPECT_LT(glm::length(*back - direction), worse * kRounding * (1 + std::hypot(u, v)));
  }
  EXPECT_GT(seen, kTrials / 10);
}

TEST(PanoramaCamera, CentresLookForwardsAndLeftIsLeft) {
  for (const Projection projection :
       {Projection::kEquirectangular, Projection::kCylindrical, Projection::kFisheyeEquidistant,
        Projection::kFisheyeEquisolid, Projection::kEqualArea}) {
    Shown s;
    s.camera.projection = projection;
    s.film.width = s.film.height = 100;
    const Camera camera = kernel_camera(s);
    const auto at = [&](int x, int y) {
      return panorama_view(camera, panorama_point(camera, film_of(s), x, y, -0.5f, -0.5f)).direction;
    };
    EXPECT_NEAR(double(at(50, 50).z), 1, 1e-6);
    EXPECT_GT(at(40, 50).x, 0.01f);
    EXPECT_LT(at(60, 50).x, -0.01f);
    EXPECT_GT(at(50, 40).y, 0.01f);
    EXPECT_LT(at(50, 60).y, -0.01f);
  }
}

TEST(PanoramaCamera, FilmPointsBeyondTheEdgesGoRoundTheSphere) {
  RandomNumbers random(3);
  Shown s;
  s.film.width = s.film.height = 64;
  const FilmParameters film = film_of(s);
  for (int i = 0; i < 200; ++i) {
    const float dx = random.between(-3, 3), dy = random.between(-0.5, 0.5);
    const int y = int(random.below(64));
    s.camera.projection = Projection::kEquirectangular;
    const Camera round = kernel_camera(s);
    const auto view = [&](const Camera& camera, int x, int row, float right, float down) {
      return wide(panorama_view(camera, panorama_point(camera, film, x, row, right, down)).direction);
    };
    EXPECT_LT(glm::length(view(round, 0, y, dx, dy) - view(round, 63, y, dx + 1, dy)), kRounding);
    // Over a pole half a turn away.
    EXPECT_LT(glm::length(view(round, 5, 0, dx, -dy - 0.5f) - view(round, 37, 0, dx, dy - 0.5f)), kRounding);
    // On the other half of the same edge.
    s.camera.projection = Projection::kEqualArea;
    const Camera square = kernel_camera(s);
    EXPECT_LT(glm::length(view(square, 0, y, -0.5f - std::abs(dx), dy) -
                          view(square, 0, 63 - y, -0.5f + std::abs(dx), -dy)),
              kRounding);
  }
}

TEST(PanoramaCamera, EveryPointOfTheLensIsInFocusAtTheDistance) {
  RandomNumbers random(4);
  for (int i = 0; i < 500; ++i) {
    Shown s = random_panorama(random, Projection::kEquirectangular);
    s.camera.aperture_radius = 0.2;
    s.camera.focus_distance = random.between(1, 5);
    const Camera camera = kernel_camera(s);
    const Exact3 way = random.direction();
    const glm::dvec3 direction(double(way.x), double(way.y), double(way.z));
    const glm::dvec3 world = glm::dmat3(s.camera.to_world) * direction, at(s.camera.to_world[3]);
    const LensPoint lens{float(random.between(-0.7, 0.7)), float(random.between(-0.7, 0.7))};
    const Ray ray = panorama_ray(camera, camera.focus.x, to_vec3(direction), 0.0f, lens);
    const glm::dvec3 target = at + s.camera.focus_distance * world;
    EXPECT_LT(glm::length(glm::cross(target - wide(ray.origin), wide(ray.direction))), 1e-5);
    // It starts on the disk, moved along to the clipping sphere.
    const double along = glm::dot(wide(ray.origin) - at, world);
    EXPECT_NEAR(along, s.camera.near_clip, 1e-5);
  }
}

TEST(PanoramaCamera, RaysOfEyesTouchTheirCircle) {
  RandomNumbers random(5);
  for (int i = 0; i < 1000; ++i) {
    Shown s = random_panorama(random, Projection::kEquirectangular);
    s.camera.stereo = StereoPair::kTopBottom;
    s.camera.interocular_distance = random.between(0.01, 0.5);
    s.camera.near_clip = 1e-4;
    const Camera camera = kernel_camera(s);
    const FilmParameters film = film_of(s);
    const int x = int(random.below(unsigned(s.film.width))), y = int(random.below(unsigned(s.film.height)));
    const int half = s.film.height / 2;
    const auto exact =
        panorama_direction(s.camera, s.film, (x + 0.5) / s.film.width, (y % half + 0.5) / half);
    const PanoramaView view = panorama_view(camera, panorama_point(camera, film, x, y, 0.0f, 0.0f));
    EXPECT_LT(glm::length(wide(view.direction) - *exact), kRounding);
    const float eye = eye_of_row(camera, film, y);
    EXPECT_NEAR(double(eye), (y < half ? 0.5 : -0.5) * s.camera.interocular_distance, 1e-6);
    const glm::dmat4 to_camera = glm::inverse(s.camera.to_world);
    const Ray ray = panorama_ray(camera, camera.focus.x, view.direction, eye, {0.0f, 0.0f});
    const glm::dvec3 start = glm::dvec3(to_camera * glm::dvec4(wide(ray.origin), 1)) - 1e-4 * *exact;
    EXPECT_NEAR(glm::length(start), std::abs(double(eye)), 2e-6);
    EXPECT_NEAR(start.y, 0, 2e-6);
    EXPECT_NEAR(glm::dot(start, *exact), 0, 2e-6);
    // The left eye is at the left: the vertical axis, start and direction are right-handed.
    EXPECT_EQ(glm::dot(glm::cross(glm::dvec3(0, 1, 0), *exact), start) > 0, eye > 0);
    // A point of the ray is imaged there again.
    const vec3 point = add_scaled(ray.origin, 0.5f + float(random.between(0, 5)), ray.direction);
    const FilmPosition p = panorama_position(camera, film, sub(point, camera.origin), false, y);
    ASSERT_TRUE(p.seen);
    const float period = panorama_period(camera, film);
    const float right = p.x - (float(x) + 0.5f), turns = std::round(right / period);
    const double sharp = std::max(0.02, std::hypot(exact->x, exact->z));  // parallels are short at the poles
    EXPECT_NEAR(double(right - turns * period), 0, 2e-5 * double(period) / sharp);
    EXPECT_NEAR(double(p.y), y + 0.5, 1e-3 * s.film.height);
  }
}

}  // namespace
}  // namespace penumbra::panorama_camera_test
