// The perspective camera against the pinhole formula: where known points appear, for every axis of the field
// of view.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>
#include <string>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

struct FilmSize {
  int width, height;
};

struct ImagePoint {
  double x = 0, y = 0;
};

/// Pixels that the whole field of view spans.
double extent(FovAxis axis, FilmSize film) {
  switch (axis) {
    case FovAxis::kX:
      return film.width;
    case FovAxis::kY:
      return film.height;
    case FovAxis::kDiagonal:
      return std::hypot(film.width, film.height);
    case FovAxis::kSmaller:
      return std::min(film.width, film.height);
    case FovAxis::kLarger:
      return std::max(film.width, film.height);
  }
  return 0;
}

/// Film position of a point in camera coordinates: x to the left, y up, z forward.
ImagePoint project(glm::dvec3 p, double fov, FovAxis axis, FilmSize film) {
  const double focal_length = extent(axis, film) / 2 / std::tan(fov / 2 * std::numbers::pi / 180);
  return {film.width / 2.0 - focal_length * p.x / p.z, film.height / 2.0 - focal_length * p.y / p.z};
}

/// Centre of gravity of the light on the film, in pixels from its upper left corner.
ImagePoint centroid(const FilmAccumulator& film) {
  double weight = 0;
  ImagePoint sum;
  for (int y = 0; y < film.height(); ++y) {
    for (int x = 0; x < film.width(); ++x) {
      const double value = film.at(x, y).mean[0];
      weight += value;
      sum.x += value * (x + 0.5);
      sum.y += value * (y + 0.5);
    }
  }
  return {sum.x / weight, sum.y / weight};
}

struct CameraCase {
  std::string name;
  FovAxis axis;
  FilmSize film;
};

void PrintTo(const CameraCase& camera_case, std::ostream* out) { *out << camera_case.name; }

class FieldOfView : public testing::TestWithParam<CameraCase> {};

TEST_P(FieldOfView, PointsAppearWhereThePinholeFormulaSays) {
  constexpr double kFov = 40;
  const auto& [name, axis, size] = GetParam();
  const glm::dvec3 eye(30, -20, 50), target(33, -18, 44), up(0.1, 1, 0.3);
  for (const ImagePoint place :
       {ImagePoint{0.5, 0.5}, ImagePoint{0.1, 0.15}, ImagePoint{0.85, 0.2}, ImagePoint{0.25, 0.9}}) {
    SceneDescription scene = empty_scene(size.width, size.height, 64, 1);
    scene.sampler.kind = SamplerKind::kSobol;
    scene.camera = look_at(eye, target, up, kFov);
    scene.camera.fov_axis = axis;
    scene.integrator = direct_integrator(1, 0);
    // A small light at a chosen place of the film, 8 to 12 units away.
    const double focal_length = extent(axis, size) / 2 / std::tan(kFov / 2 * std::numbers::pi / 180);
    const double z = 8 + 4 * place.x;
    const glm::dvec3 local((0.5 - place.x) * size.width / focal_length * z,
                           (0.5 - place.y) * size.height / focal_length * z, z);
    Shape light;
    light.name = "light";
    const double radius = 1.5 * z / focal_length;  // a pixel and a half on the film
    light.geometry = Sphere{glm::dvec3(scene.camera.to_world * glm::dvec4(local, 1)), radius};
    light.radiance = glm::vec3(1);
    scene.shapes.push_back(light);

    const ImagePoint expected = project(local, kFov, axis, size);
    const ImagePoint found = centroid(render_or_throw(scene));
    // Some 450 of 64 samples in each pixel lie on the light; stratified, their mean is known to a few
    // hundredths of its radius. The ellipse that a sphere projects to is off its centre by less than (r/z)^2
    // of the offset.
    EXPECT_NEAR(found.x, expected.x, 0.05) << "light at " << place.x << ", " << place.y;
    EXPECT_NEAR(found.y, expected.y, 0.05) << "light at " << place.x << ", " << place.y;
  }
}

INSTANTIATE_TEST_SUITE_P(Axes, FieldOfView,
                         testing::Values(CameraCase{"XWide", FovAxis::kX, {64, 40}},
                                         CameraCase{"XTall", FovAxis::kX, {40, 64}},
                                         CameraCase{"YWide", FovAxis::kY, {64, 40}},
                                         CameraCase{"YTall", FovAxis::kY, {40, 64}},
                                         CameraCase{"DiagonalWide", FovAxis::kDiagonal, {64, 40}},
                                         CameraCase{"DiagonalTall", FovAxis::kDiagonal, {40, 64}},
                                         CameraCase{"SmallerWide", FovAxis::kSmaller, {64, 40}},
                                         CameraCase{"SmallerTall", FovAxis::kSmaller, {40, 64}},
                                         CameraCase{"LargerWide", FovAxis::kLarger, {64, 40}},
                                         CameraCase{"LargerTall", FovAxis::kLarger, {40, 64}}),
                         [](const auto& info) { return info.param.name; });

TEST(FeatureLayers, DepthNormalAndAlbedoOfASphere) {
  // Looking down the axis at a sphere of radius 2, 10 away: its nearest point, and the sky beside it.
  SceneDescription scene = empty_scene(33, 33, 16, 1);
  scene.camera = look_at(glm::dvec3(0, 0, -10), glm::dvec3(0), glm::dvec3(0, 1, 0), 40);
  Shape sphere;
  sphere.name = "sphere";
  sphere.geometry = Sphere{glm::dvec3(0), 2};
  sphere.front_bsdf = add_diffuse(scene, 0.3f);
  scene.shapes.push_back(sphere);
  scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
  scene.integrator = direct_integrator(0, 1);  // exact under a white sky
  const FilmAccumulator film = render_or_throw(scene);

  const PixelStatistics& middle = film.at(16, 16);
  // Within half a pixel of the axis, .5 / 33 * 2 tan 20 * 8 = .09 off it, a sphere falls back by .09^2 / (2 *
  // 2).
  EXPECT_NEAR(film.layer(16, 16, LAYER_DEPTH), 8, 5e-3);
  EXPECT_NEAR(film.layer(16, 16, LAYER_NORMAL, 2), -1, 2e-3);
  EXPECT_NEAR(film.layer(16, 16, LAYER_NORMAL), 0, 0.03);
  EXPECT_NEAR(film.layer(16, 16, LAYER_ALBEDO, 1), 0.3, 1e-6);
  // An unshadowed convex body under a white sky shows its albedo.
  EXPECT_NEAR(middle.mean[1], 0.3, 1e-5);

  const PixelStatistics& corner = film.at(0, 0);
  EXPECT_EQ(film.layer(0, 0, LAYER_DEPTH), 0);
  EXPECT_EQ(film.layer(0, 0, LAYER_NORMAL, 2), 0);
  EXPECT_EQ(film.layer(0, 0, LAYER_ALBEDO), 0);
  EXPECT_NEAR(corner.mean[0], 1, 1e-6);

  // The left of the image is the camera's +x, the top its +y.
  EXPECT_GT(film.layer(16, 10, LAYER_NORMAL, 1), 0.2);
  EXPECT_GT(film.layer(10, 16, LAYER_NORMAL) * (scene.camera.to_world[0][0]), 0.2);
}

TEST(Clipping, NothingNearerOrFartherIsSeen) {
  SceneDescription scene = empty_scene(1, 1, 4, 1);
  scene.integrator = direct_integrator(1, 0);
  scene.shapes.push_back(parallelogram({-1, -1, 5}, {0, 2, 0}, {2, 0, 0}, kBlackBsdf, 1));
  scene.camera.near_clip = 4.9;
  scene.camera.far_clip = 5.1;
  EXPECT_EQ(pixel_sample(render_or_throw(scene), 0, 0, 0).mean(), 1);
  scene.camera.near_clip = 5.05;
  EXPECT_EQ(pixel_sample(render_or_throw(scene), 0, 0, 0).mean(), 0);
  scene.camera.near_clip = 0.1;
  scene.camera.far_clip = 4.95;
  EXPECT_EQ(pixel_sample(render_or_throw(scene), 0, 0, 0).mean(), 0);
}

}  // namespace
}  // namespace penumbra
