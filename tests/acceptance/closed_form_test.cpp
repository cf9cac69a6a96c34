// Disks, spheres, point lights and skies over a diffuse floor, in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/strategies.h"
#include "tests/support/render_scene.h"

namespace penumbra::closed_form_test {
namespace {

constexpr double kSignificance = 0.01;
constexpr std::uint32_t kSamples = 100'000;
constexpr double kRounding = 32.0 / (1 << 24);  ///< see furnace_test.cpp
constexpr float kAlbedo = 0.5f;

Shape disk(glm::dvec3 center, glm::dvec3 normal, double radius, int bsdf,
           std::optional<float> radiance = std::nullopt) {
  Shape shape;
  shape.name = "disk";
  shape.geometry = Disk{center, normal, radius};
  shape.front_bsdf = shape.back_bsdf = bsdf;
  if (radiance) shape.radiance = glm::vec3(*radiance);
  return shape;
}

/// One pixel that sees the origin of a diffuse floor y = 0 from close above.
SceneDescription diffuse_floor() {
  SceneDescription scene = empty_scene(1, 1, kSamples, 1);
  scene.camera = look_at(glm::dvec3(0, 0.01, 0), glm::dvec3(0), glm::dvec3(0, 0, 1), 1e-6);
  scene.shapes.push_back(
      parallelogram({-100, 0, -100}, {0, 0, 200}, {200, 0, 0}, add_diffuse(scene, kAlbedo)));
  return scene;
}

void expect_radiance(SceneDescription scene, const IntegratorSettings& integrator, double expected) {
  scene.integrator = integrator;
  TestDevice device = native_device();
  device.samples_per_pass = kMaxSamplesPerUnit;
  const statistics::Sample sample = pixel_sample(render_or_throw(scene, device), 0, 0, 1);
  ASSERT_EQ(sample.count(), scene.sampler.spp);
  EXPECT_GT(statistics::t_test(sample, expected, expected * kRounding).p, kSignificance)
      << sample.mean() << " +- " << sample.standard_error() << ", expected " << expected;
}

class ClosedForm : public testing::TestWithParam<Strategy> {};

TEST_P(ClosedForm, DiskLightAboveTheFloor) {
  // A disk of radius r, parallel to the floor at height d above the point: E = pi L r^2 / (r^2 + d^2).
  for (const auto& [d, r] : {std::pair(2.0, 1.0), std::pair(1.0, 1.0), std::pair(0.5, 2.0)}) {
    SceneDescription scene = diffuse_floor();
    scene.shapes.push_back(disk({0, d, 0}, {0, -1, 0}, r, kBlackBsdf, 3));
    SCOPED_TRACE(testing::Message() << "height " << d << ", radius " << r);
    expect_radiance(scene, GetParam().integrator, kAlbedo * 3 * r * r / (r * r + d * d));
  }
}

TEST_P(ClosedForm, DiskLightSeenFromBehindIsDark) {
  SceneDescription scene = diffuse_floor();
  scene.shapes.push_back(disk({0, 2, 0}, {0, 1, 0}, 1, kBlackBsdf, 3));
  expect_radiance(scene, GetParam().integrator, 0);
}

/// Irradiance of the floor at the origin from the side of the cylinder that emits, outside or inside,
/// radiance 1: by the midpoints of a grid.
/// The relative error for these cylinders is below 2e-5.
double cylinder_irradiance(const Cylinder& c, double side) {
  constexpr int kAround = 800, kAlong = 200;
  double sum = 0;
  for (int i = 0; i < kAround; ++i) {
    const double phi = 2 * std::numbers::pi * (i + 0.5) / kAround;
    const glm::dvec3 n = std::cos(phi) * c.x_axis + std::sin(phi) * c.y_axis;
    for (int j = 0; j < kAlong; ++j) {
      const glm::dvec3 p = c.center + c.length * (j + 0.5) / kAlong * c.axis + c.radius * n;
      const double d2 = glm::dot(p, p), at_light = -side * glm::dot(n, p), at_floor = p.y;
      if (at_light > 0 && at_floor > 0) sum += at_light * at_floor / (d2 * d2);
    }
  }
  return sum * 2 * std::numbers::pi * c.radius * c.length / (double(kAround) * kAlong);
}

TEST_P(ClosedForm, CylinderLightAboveTheFloor) {
  const auto along = [](glm::dvec3 center, glm::dvec3 axis, double radius, double length) {
    const glm::dvec3 z = glm::normalize(axis), x = glm::normalize(glm::cross(z, glm::dvec3(0.3, 0.1, 1)));
    return Cylinder{center, z, radius, length, x, glm::cross(z, x)};
  };
  // A lying tube, one that leans, and one from within, seen through its open end: the floor's point is
  // between its ends.
  for (const auto& [cylinder, inside] : {std::pair(along({-1, 1, 0.2}, {1, 0, 0}, 0.3, 2), false),
                                         std::pair(along({0.5, 0.8, 0.4}, {0.3, 1, -0.2}, 0.25, 1.5), false),
                                         std::pair(along({0.1, 0.05, 0}, {0, 1, 0}, 0.7, 1), true)}) {
    SceneDescription scene = diffuse_floor();
    Shape area_light;
    area_light.name = "cylinder";
    area_light.geometry = cylinder;
    area_light.front_bsdf = area_light.back_bsdf = kBlackBsdf;
    area_light.radiance = glm::vec3(3.0f);
    area_light.flip_normals = inside;
    scene.shapes.push_back(area_light);
    const double expected = cylinder_irradiance(cylinder, inside ? -1 : 1);
    EXPECT_GT(expected, 0.05);
    expect_radiance(scene, GetParam().integrator, kAlbedo / std::numbers::pi * 3 * expected);
  }
}

TEST_P(ClosedForm, SphereLightAboveTheFloor) {
  // A sphere at angle t from the normal, all above the horizon: E = pi L (r / d)^2 cos t.
  const glm::dvec3 center(0.8, 1.5, -0.4);
  const double radius = 0.7, distance = glm::length(center);
  SceneDescription scene = diffuse_floor();
  Shape sphere;
  sphere.name = "sphere";
  sphere.geometry = Sphere{center, radius};
  sphere.radiance = glm::vec3(2);
  scene.shapes.push_back(sphere);
  expect_radiance(scene, GetParam().integrator,
                  kAlbedo * 2 * radius * radius / (distance * distance) * center.y / distance);
}

TEST_P(ClosedForm, DiskHidesPartOfAConstantSky) {
  // A black disk hides the directions within the angle t of the zenith, tan t = r / d: what is left of the
  // irradiance pi L is cos^2 t. (cos t is the visible share of the hemisphere: .894427 and .707107.)
  for (const auto& [d, r, visible] : {std::tuple(2.0, 1.0, 0.894427191), std::tuple(1.0, 1.0, 0.70710678118),
                                      std::tuple(2.0, 2.0, 0.70710678118)}) {
    SceneDescription scene = diffuse_floor();
    scene.emitters.emplace_back(ConstantEnvironment{glm::vec3(1)});
    scene.shapes.push_back(disk({0, d, 0}, {0, -1, 0}, r, kBlackBsdf));
    SCOPED_TRACE(testing::Message() << "height " << d << ", radius " << r);
    expect_radiance(scene, GetParam().integrator, kAlbedo * visible * visible);
  }
}

INSTANTIATE_TEST_SUITE_P(Strategies, ClosedForm, testing::ValuesIn(all_strategies()),
                         [](const auto& info) { return strategy_name(info); });

/// Two unit disks at y = -1 and y = 1 that face each other; the camera, between them, sees the middle of the
/// lower.
double between_disks(glm::dvec3 light, double power) {
  SceneDescription scene = empty_scene(1, 1, 16, 1);
  scene.camera = look_at(glm::dvec3(0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1), 1e-6);
  const int grey = add_diffuse(scene, kAlbedo);
  scene.shapes.push_back(disk({0, -1, 0}, {0, 1, 0}, 1, grey));
  scene.shapes.push_back(disk({0, 1, 0}, {0, -1, 0}, 1, grey));
  scene.emitters.emplace_back(PointLight{light, glm::vec3(float(power / (4 * std::numbers::pi)))});
  scene.integrator = direct_integrator(1, 1);
  return pixel_sample(render_or_throw(scene), 0, 0, 0).mean();
}

TEST(PointLight, BetweenTwoDisks) {
  // Shadow rays start a little off the surface, by at most 1e-5 of the scene's size; the table has six
  // digits.
  EXPECT_NEAR(between_disks({0, 0, 0}, 78.956835), 1, 1e-5);
  EXPECT_NEAR(between_disks({0.5, 0.1, 0}, 8), 0.0631777, 5e-7);
}

TEST(PointLight, HiddenBehindADisk) { EXPECT_EQ(between_disks({0.5, 2, 0}, 8), 0); }

}  // namespace
}  // namespace penumbra::closed_form_test
