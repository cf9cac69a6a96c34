// Images of panoramic cameras against closed forms: constant worlds, the area of a sphere's image, stereo
// pairs, the seam, motion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "kernels/film_layers.h"
#include "scenes/panoramas.h"
#include "tests/acceptance/motion_pieces.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/panorama_directions.h"
#include "tests/support/render_scene.h"

namespace penumbra::panorama_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Projection kAll[] = {Projection::kEquirectangular, Projection::kCylindrical,
                               Projection::kFisheyeEquidistant, Projection::kFisheyeEquisolid,
                               Projection::kEqualArea};

/// A panorama from the origin along z.
SceneDescription panorama(Projection projection, int width, int height, std::uint32_t spp) {
  SceneDescription scene = empty_scene(width, height, spp, 3);
  scene.integrator = direct_integrator(1, 1);
  scene.camera.projection = projection;
  return scene;
}

Shape sphere(glm::dvec3 center, double radius, float radiance = 1.0f) {
  Shape shape;
  shape.name = "sphere";
  shape.geometry = Sphere{.center = center, .radius = radius};
  shape.front_bsdf = kBlackBsdf;
  shape.radiance = glm::vec3(radiance);
  return shape;
}

glm::dvec3 direction_of(double longitude, double latitude) {
  return {-std::sin(longitude) * std::cos(latitude), std::sin(latitude),
          std::cos(longitude) * std::cos(latitude)};
}

TEST(Panorama, OfAConstantSkyIsConstant) {
  for (const Projection projection : kAll) {
    SceneDescription scene = panorama(projection, 24, 24, 16);
    scene.emitters.emplace_back(ConstantEnvironment{.radiance = glm::vec3(0.75f)});
    scene.film.alpha = true;
    scene.camera.fisheye_fov = 200;
    scene.camera.fisheye_lens = 12;
    const FilmAccumulator film = render_or_throw(scene);
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) {
        int corners = 0;
        for (const double u : {0.0, 1.0})
          for (const double v : {0.0, 1.0})
            corners += panorama_direction(scene.camera, scene.film, (x + u) / 24, (y + v) / 24) ? 1 : 0;
        const double mean = pixel_sample(film, x, y, 1).mean(), alpha = film.layer(x, y, LAYER_COVERAGE);
        if (corners == 4) {
          EXPECT_NEAR(mean, 0.75, 1e-6);
          EXPECT_EQ(alpha, 1);
        } else if (corners == 0) {
          EXPECT_EQ(mean, 0);
          EXPECT_EQ(alpha, 0);
        } else {  // the circle's edge
          EXPECT_NEAR(mean, 0.75 * alpha, 1e-6);
        }
      }
  }
}

/// The number of pixels that a sphere covers.
struct Area {
  double pixels = 0, deviation = 0;
};
Area covered_area(const FilmAccumulator& film) {
  Area area;
  double variance = 0;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) {
      const statistics::Sample sample = pixel_sample(film, x, y, 1);
      area.pixels += sample.mean();
      variance += sample.mean() * (1 - sample.mean()) / double(sample.count());
    }
  area.deviation = std::sqrt(variance);
  return area;
}

/// Of a sphere of angular radius `size` at a direction; 4.9 standard deviations: 1e-6.
void expect_area(SceneDescription scene, double longitude, double latitude, double size, double expected) {
  scene.shapes.push_back(sphere(5.0 * direction_of(longitude, latitude), 5.0 * std::sin(size)));
  const Area area = covered_area(render_or_throw(scene));
  EXPECT_NEAR(area.pixels, expected, 4.9 * area.deviation + 1e-4 * expected)
      << projection_name(scene.camera.projection) << " at " << longitude << ", " << latitude;
}

/// The integral of f from -size to size, which goes to 0 at both ends as a square root.
double over_cap(double size, const std::function<double(double)>& f) {
  constexpr int kSteps = 2000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = -kPi / 2 + kPi * (i + 0.5) / kSteps;
    sum += f(size * std::sin(angle)) * size * std::cos(angle) * kPi / kSteps;
  }
  return sum;
}

TEST(Panorama, ASphereCoversTheAreaOfItsProjection) {
  constexpr int kWidth = 48, kHeight = 40;
  constexpr std::uint32_t kSpp = 256;
  const double size = 0.35;
  // Half the width in longitude of a cap about the horizon: cos(size) = cos(latitude) cos(longitude).
  const auto half_width = [&](double latitude) { return std::acos(std::cos(size) / std::cos(latitude)); };

  SceneDescription scene = panorama(Projection::kEquirectangular, kWidth, kHeight, kSpp);
  const double per_square_radian = kWidth * kHeight / (2 * kPi * kPi);
  const double on_horizon = over_cap(size, [&](double latitude) { return 2 * half_width(latitude); });
  for (const double longitude : {0.0, 1.0, kPi, -2.5})
    expect_area(scene, longitude, 0, size, on_horizon * per_square_radian);
  expect_area(scene, 0, kPi / 2, size, kWidth * kHeight * size / kPi);
  expect_area(scene, 0, -kPi / 2, size, kWidth * kHeight * size / kPi);
  // A part: 120 by 60 degrees.
  scene.camera.longitude_min = 30, scene.camera.longitude_max = 150;
  scene.camera.latitude_min = -30, scene.camera.latitude_max = 30;
  expect_area(scene, kPi / 2, 0, size, on_horizon * kWidth * kHeight / (kPi * kPi * 2 / 9));

  scene = panorama(Projection::kCylindrical, kWidth, kHeight, kSpp);
  scene.camera.height_min = -0.5, scene.camera.height_max = 1;
  const double on_cylinder = over_cap(
      size, [&](double latitude) { return 2 * half_width(latitude) / std::pow(std::cos(latitude), 2); });
  expect_area(scene, 1, 0, size, on_cylinder * kWidth * kHeight / (2 * kPi * 1.5));

  scene = panorama(Projection::kFisheyeEquidistant, kWidth, kHeight, kSpp);
  scene.camera.fisheye_fov = 120;
  const double per_radian = kWidth / (120 * kPi / 180);
  expect_area(scene, 0, 0, size, kPi * std::pow(size * per_radian, 2));
  scene.camera.fov_axis = FovAxis::kSmaller;
  expect_area(scene, 0, 0, size, kPi * std::pow(size * per_radian * kHeight / kWidth, 2));
  // All around: a sphere behind covers a ring.
  scene.camera.fisheye_fov = 360;
  expect_area(scene, kPi, 0, size,
              kPi * (std::pow(kHeight / 2.0, 2) - std::pow((1 - size / kPi) * kHeight / 2, 2)));

  const double solid_angle = 2 * kPi * (1 - std::cos(size));
  scene = panorama(Projection::kFisheyeEquisolid, kWidth, kHeight, kSpp);
  scene.camera.fisheye_fov = 360;
  scene.camera.fisheye_lens = 8;
  const double focal = 8 * kWidth / scene.camera.sensor_width;
  for (const double longitude : {0.0, 0.7, kPi}) {
    // The circle of 360 degrees has to be on the film.
    scene.camera.fisheye_lens = longitude == kPi ? 7 : 8;
    const double f = longitude == kPi ? focal * 7 / 8 : focal;
    expect_area(scene, longitude, 0.2 * (longitude < 3), size, solid_angle * f * f);
  }
  scene = panorama(Projection::kEqualArea, kHeight, kHeight, kSpp);
  for (const double longitude : {0.0, 0.7, 1.5, kPi})
    expect_area(scene, longitude, 0.3, size, solid_angle / (4 * kPi) * kHeight * kHeight);
}

/// The mean position of the light of a sphere in the rows of one picture.
double centroid_x(const FilmAccumulator& film, int first, int last) {
  double sum = 0, weight = 0;
  for (int y = first; y < last; ++y)
    for (int x = 0; x < film.width(); ++x) {
      const double mean = pixel_sample(film, x, y, 1).mean();
      sum += (x + 0.5) * mean;
      weight += mean;
    }
  return sum / weight;
}

TEST(Panorama, DistancesFollowFromTheDisparityOfAStereoPair) {
  constexpr int kWidth = 360, kHeight = 60;
  for (const double distance : {1.5, 4.0}) {
    SceneDescription scene = panorama(Projection::kEquirectangular, kWidth, kHeight, 64);
    scene.camera.stereo = StereoPair::kTopBottom;
    scene.camera.interocular_distance = 0.5;
    scene.camera.latitude_min = -15, scene.camera.latitude_max = 15;
    scene.shapes.push_back(sphere(distance * direction_of(0.6, 0), 0.1));
    const FilmAccumulator film = render_or_throw(scene);
    const double left = centroid_x(film, 0, kHeight / 2), right = centroid_x(film, kHeight / 2, kHeight);
    // Rays that touch a circle of radius e reach the distance d at the angle asin(e / d) from where they go.
    // The left eye sees a point farther to the right.
    const double degrees = 2 * std::asin(0.25 / distance) * 180 / kPi;
    // Some 15 pixels high and wide of 64 samples each: their centroid is within 0.05 pixels.
    EXPECT_NEAR(left - right, degrees, 0.1);
    EXPECT_NEAR(0.5 * (left + right), 180 + 0.6 * 180 / kPi, 0.1);
  }
}

TEST(Panorama, FiltersReachAcrossTheSeam) {
  // Half a sky: a square before the camera that covers one side. Turned by half a turn, the seam is
  // elsewhere.
  SceneDescription scene = panorama(Projection::kEquirectangular, 16, 8, 1024);
  scene.film.filter = FilterKind::kGaussian;
  scene.film.filter_radius = 2.0f;
  scene.shapes.push_back(sphere(glm::dvec3(0.6, 0.2, -2), 0.9));
  const FilmAccumulator seam = render_or_throw(scene);
  scene.camera.to_world = glm::dmat4(glm::dvec4(-1, 0, 0, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, -1, 0),
                                     glm::dvec4(0, 0, 0, 1));
  scene.sampler.seed = 99;
  const FilmAccumulator middle = render_or_throw(scene);
  int mixed = 0;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) {
      const statistics::Sample a = pixel_sample(seam, x, y, 1), b = pixel_sample(middle, (x + 8) % 16, y, 1);
      const double p = 0.5 * (a.mean() + b.mean());
      // 4.9 standard deviations.
      EXPECT_NEAR(a.mean(), b.mean(), 4.9 * std::sqrt(2 * p * (1 - p) / 1024) + 1e-3) << x << ", " << y;
      mixed += (x == 0 || x == 15) && p > 0.05 && p < 0.95 ? 1 : 0;
    }
  EXPECT_GT(mixed, 1);
}

/// By the longitude and latitude of a point, in pixels of one picture.
glm::dvec2 image_of(const SceneDescription& scene, glm::dvec3 p) {
  return {(0.5 + std::atan2(-p.x, p.z) / (2 * kPi)) * scene.film.width,
          (0.5 - std::atan2(p.y, std::hypot(p.x, p.z)) / kPi) * scene.film.height};
}

TEST(Panorama, MotionIsThatOfTheExactProjectionAndTheShorterWayRound) {
  // A wall behind the camera, over the seam.
  SceneDescription scene = panorama(Projection::kEquirectangular, 32, 16, 64);
  const glm::dvec3 way(0.5, 0.2, -0.3);
  scene.shapes.push_back(parallelogram({-6, -6, -2}, {12, 0, 0}, {0, 12, 0}, kBlackBsdf, 1));
  scene.film.layers = {AskedLayer::kMotion};
  scene.camera.shutter = 0.0f;
  scene.frame_duration = 1.0;
  {
    motion_pieces::Mover move(scene);
    move.last_shape(move.node({{-1, glm::translate(glm::dmat4(1), -way)},
                               {0, glm::dmat4(1)},
                               {2, glm::translate(glm::dmat4(1), 2.0 * way)}}));
  }
  ASSERT_TRUE(set_time(scene, 0));
  const FilmAccumulator film = render_or_throw(scene);
  int seen = 0;
  for (int y = 5; y < 11; ++y)
    for (const int x : {0, 1, 2, 3, 28, 29, 30, 31}) {
      glm::dvec2 before(0), after(0);
      constexpr int kGrid = 8;
      bool inside = true;
      for (int k = 0; k < kGrid * kGrid; ++k) {
        const auto d = panorama_direction(scene.camera, scene.film, (x + (k % kGrid + 0.5) / kGrid) / 32,
                                          (y + (k / kGrid + 0.5) / kGrid) / 16);
        const glm::dvec3 p = -2 / d->z * *d;
        inside = inside && d->z < 0 && std::max(std::abs(p.x), std::abs(p.y)) < 5.5;
        const glm::dvec2 now = image_of(scene, p);
        const auto to = [&](glm::dvec3 q) {
          glm::dvec2 moved = image_of(scene, q) - now;
          moved.x -= 32 * std::round(moved.x / 32);
          return moved / double(kGrid * kGrid);
        };
        before += to(p - way);
        after += to(p + way);
      }
      ASSERT_TRUE(inside);
      ++seen;
      // Motions of some pixels change by less than one within a pixel: the mean of 64 samples is within 0.2.
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_NEAR(film.layer(x, y, LAYER_MOTION_BEFORE, axis), before[axis], 0.2) << x << ", " << y;
        EXPECT_NEAR(film.layer(x, y, LAYER_MOTION_AFTER, axis), after[axis], 0.2) << x << ", " << y;
      }
    }
  EXPECT_EQ(seen, 48);
}

TEST(Panorama, DepthIsADistanceAndPositionsAreWhereItIs) {
  for (const Projection projection : kAll) {
    SceneDescription scene = panorama(projection, 16, 16, 4);
    scene.camera.fisheye_fov = 300;
    scene.camera.near_clip = 0.1;
    scene.film.layers = {AskedLayer::kPosition};
    scene.shapes.push_back(sphere(glm::dvec3(0), 4));
    scene.shapes.back().flip_normals = true;
    const FilmAccumulator film = render_or_throw(scene);
    for (int y = 4; y < 12; ++y)
      for (int x = 4; x < 12; ++x) {
        EXPECT_NEAR(film.layer(x, y, LAYER_DEPTH), 4 - 0.1, 1e-4);
        const glm::dvec3 p(film.layer(x, y, LAYER_POSITION, 0), film.layer(x, y, LAYER_POSITION, 1),
                           film.layer(x, y, LAYER_POSITION, 2));
        const auto d = panorama_direction(scene.camera, scene.film, (x + 0.5) / 16, (y + 0.5) / 16);
        EXPECT_LT(glm::length(p / 4.0 - *d), 0.35) << projection_name(projection);
      }
  }
}

/// A ball and, but for the cylindrical one, the camera move.
SceneDescription moving_panorama(Projection projection) {
  SceneDescription scene = panorama(projection, 16, 12, 8);
  scene.film.alpha = true;
  scene.film.layers = {AskedLayer::kPosition, AskedLayer::kMotion};
  scene.camera.fisheye_fov = 170;
  scene.camera.aperture_radius = projection == Projection::kCylindrical ? 0.1 : 0.0;
  if (projection == Projection::kEquirectangular) scene.camera.stereo = StereoPair::kTopBottom;
  scene.emitters.emplace_back(ConstantEnvironment{.radiance = glm::vec3(0.5f)});
  scene.shapes.push_back(sphere(glm::dvec3(0.6, 0.2, 2), 0.9));
  scene.camera.shutter = 1.0f;
  scene.frame_duration = 1.0;
  motion_pieces::Mover move(scene);
  const int node = move.node(glm::dvec3(0.3, 0, 0.1), 20);
  move.last_shape(node);
  if (projection != Projection::kCylindrical) move.camera(node);
  return scene;
}

TEST(Panorama, OpenClGivesTheSameBits) {
  std::vector<DeviceScene> scenes;
  for (const Projection projection : kAll) scenes.push_back(build_or_throw(moving_panorama(projection)));
  share_needs(scenes);
  for (std::size_t i = 0; i < scenes.size(); ++i)
    EXPECT_EQ(render_or_throw(scenes[i], opencl_device()).hash(), render_or_throw(scenes[i]).hash())
        << projection_name(kAll[i]);
}

TEST(Panorama, OpenClKernelsForEachAloneGiveTheSameBits) {
  for (const Projection projection : kAll) {
    const DeviceScene scene = build_or_throw(moving_panorama(projection));
    EXPECT_EQ(render_or_throw(scene, opencl_device()).hash(), render_or_throw(scene).hash())
        << projection_name(projection);
  }
}

TEST(PanoramaErrors, SayWhatWouldBeRight) {
  const auto message = [](const std::function<void(CameraSettings&, Film&)>& change) {
    SceneDescription scene = panorama(Projection::kEquirectangular, 16, 8, 1);
    change(scene.camera, scene.film);
    const auto checked = check_camera(scene.camera, scene.film);
    return checked ? std::string("accepted") : checked.error().message;
  };
  const auto expect = [&](const char* part, const std::function<void(CameraSettings&, Film&)>& change) {
    EXPECT_NE(message(change).find(part), std::string::npos) << message(change);
  };
  EXPECT_EQ(message([](CameraSettings&, Film&) {}), "accepted");
  expect("at most 360", [](CameraSettings& c, Film&) { c.longitude_max = 190; });
  expect("less than", [](CameraSettings& c, Film&) { c.longitude_max = -200; });
  expect("from -90 to 90", [](CameraSettings& c, Film&) { c.latitude_max = 91; });
  expect("latitude_min < latitude_max", [](CameraSettings& c, Film&) { c.latitude_min = 90; });
  expect("height_max", [](CameraSettings& c, Film&) {
    c.projection = Projection::kCylindrical;
    c.height_max = -1;
  });
  expect("at most 360 degrees, not 400", [](CameraSettings& c, Film&) {
    c.projection = Projection::kFisheyeEquidistant;
    c.fisheye_fov = 400;
  });
  expect("no distortion_k1", [](CameraSettings& c, Film&) { c.distortion_k1 = 0.1; });
  expect("no magnify_red", [](CameraSettings& c, Film&) { c.magnify_blue = 0.1; });
  expect("only fisheyes", [](CameraSettings& c, Film&) { c.principal_point_offset_x = 0.1; });
  expect("even height", [](CameraSettings& c, Film& film) {
    c.stereo = StereoPair::kTopBottom;
    film.height = 9;
  });
  for (const Projection projection : {Projection::kPerspective, Projection::kCylindrical})
    expect("needs the projection equirectangular", [=](CameraSettings& c, Film&) {
      c.stereo = StereoPair::kTopBottom;
      c.projection = projection;
    });
}

}  // namespace
}  // namespace penumbra::panorama_test
