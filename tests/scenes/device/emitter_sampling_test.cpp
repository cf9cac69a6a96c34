// The emitter sampling that the builder chooses, and the variances that it compares.
#include "scenes/device/emitter_sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "kernels/host/device_scene.h"
#include "scenes/device/device_scene_builder.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra::emitter_sampling_test {
namespace {

/// A square of this half-width about (0, 0, height), its front down.
Shape square(double half, double height, bool emits) {
  Mesh mesh;
  mesh.positions = {
      {-half, -half, height}, {-half, half, height}, {half, half, height}, {half, -half, height}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  Shape shape;
  shape.geometry = mesh;
  if (emits) shape.radiance = glm::vec3(1);
  return shape;
}

std::vector<LightTriangle> triangles_of(const Shape& shape) {
  const Mesh& mesh = std::get<Mesh>(shape.geometry);
  std::vector<LightTriangle> triangles;
  const auto corner = [&](unsigned i) {
    const glm::dvec3 p = mesh.positions[i];
    return make_vec3(float(p.x), float(p.y), float(p.z));
  };
  for (const glm::uvec3& t : mesh.triangles) triangles.push_back({corner(t.x), corner(t.y), corner(t.z)});
  return triangles;
}

TEST(SamplingVariance, OfASquareAboveItsCentreByQuadrature) {
  // At distance 1 and with both cosines 1 / r, irradiance is the integral of r^-4, and the second moments are
  // A times that of r^-8 and Omega times that of cos^2 r^-3 = r^-5, all over the square.
  for (double half : {0.1, 0.5, 1.0}) {
    constexpr int kSteps = 400;
    double solid_angle = 0, first = 0, area_second = 0, angle_second = 0;
    const double area = 4 * half * half, cell = area / (kSteps * kSteps);
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        const double x = half * (2 * (i + 0.5) / kSteps - 1), y = half * (2 * (j + 0.5) / kSteps - 1);
        const double r = std::sqrt(1 + x * x + y * y);
        solid_angle += cell * std::pow(r, -3);
        first += cell * std::pow(r, -4);
        area_second += cell * area * std::pow(r, -8);
        angle_second += cell * std::pow(r, -5);
      }
    angle_second *= solid_angle;
    const std::vector<LightTriangle> triangles = triangles_of(square(half, 1, true));
    const std::vector<Receiver> receiver{{{0, 0, 0}, {0, 0, 1}}};
    const SamplingVariance v = sampling_variance(triangles, merge_coplanar(triangles), false, receiver);
    // These are nearly variances of x^2 + y^2, of which n midpoints a side have (1 - 1 / n^2)(1 - 4 / n^2).
    const double by_area = area_second / (first * first) - 1, by_angle = angle_second / (first * first) - 1;
    EXPECT_NEAR(v.area, by_area, by_area * 5 / 36) << half;
    EXPECT_NEAR(v.solid_angle, by_angle, by_angle * 5 / 36) << half;
    EXPECT_LT(v.solid_angle, v.area);
  }
}

TEST(SamplingVariance, NothingInFrontHasNone) {
  const std::vector<LightTriangle> triangles = triangles_of(square(1, 1, true));
  const std::vector<Receiver> behind{{{0, 0, 2}, {0, 0, 1}}};
  const SamplingVariance v = sampling_variance(triangles, merge_coplanar(triangles), false, behind);
  EXPECT_EQ(v.area, 0);
  EXPECT_EQ(v.solid_angle, 0);
  EXPECT_GT(sampling_variance(triangles, merge_coplanar(triangles), true, behind).area, 0);
}

TEST(LightReceivers, AreSpreadByArea) {
  SceneDescription scene;
  scene.shapes = {square(1, 0, false), square(std::sqrt(3.0), 5, false)};
  const std::vector<Receiver> receivers = light_receivers(scene, {0, 0, 1});
  ASSERT_EQ(receivers.size(), std::size_t(kReceivers));
  int low = 0;
  for (const Receiver& receiver : receivers) {
    low += receiver.p.z < 0 ? 1 : 0;
    EXPECT_TRUE(receiver.p.z == -1 || receiver.p.z == 4);
    EXPECT_DOUBLE_EQ(std::abs(receiver.n.z), 1);
  }
  EXPECT_EQ(low, kReceivers / 4);
  EXPECT_TRUE(light_receivers(SceneDescription(), {0, 0, 0}).empty());
}

/// EMITTER_* of the square light of this half-width, 1 above a floor of 4 x 4.
int chosen(double half, IntegratorSettings integrator, EmitterSampling wanted = EmitterSampling::kAuto) {
  SceneDescription scene;
  scene.shapes = {square(2, 0, false), square(half, 1, true)};
  scene.shapes[1].sampling = wanted;
  scene.integrator = integrator;
  const DeviceScene built = build_device_scene(scene, {}).value();
  const bool has_bit = (built.header.features & FEATURE_SOLID_ANGLE) != 0u;
  const Light& light = table<Light>(built, built.header.tables.lights)[0];
  EXPECT_EQ(has_bit, light.sampling == EMITTER_SOLID_ANGLE);
  return light.sampling;
}

TEST(EmitterSampling, LargeLightsBySolidAngleSmallOnesByArea) {
  const IntegratorSettings direct{.method = DirectIntegrator{}}, path{.method = PathIntegrator{}};
  EXPECT_EQ(chosen(0.01, direct), EMITTER_AREA);
  EXPECT_EQ(chosen(0.5, direct), EMITTER_SOLID_ANGLE);
  EXPECT_EQ(chosen(0.1, path), EMITTER_AREA);
  EXPECT_EQ(chosen(2, path), EMITTER_SOLID_ANGLE);
}

TEST(EmitterSampling, WhatIsSetStays) {
  const IntegratorSettings direct{.method = DirectIntegrator{}};
  EXPECT_EQ(chosen(2, direct, EmitterSampling::kArea), EMITTER_AREA);
  EXPECT_EQ(chosen(0.01, direct, EmitterSampling::kSolidAngle), EMITTER_SOLID_ANGLE);
  EXPECT_EQ(chosen(2, direct, EmitterSampling::kProjected), EMITTER_PROJECTED);
  IntegratorSettings by_area = direct;
  param::emitter_sampling(by_area) = EmitterSampling::kArea;
  EXPECT_EQ(chosen(2, by_area), EMITTER_AREA);
}

TEST(EmitterSampling, WithoutEmitterSamplesNothingIsChosen) {
  EXPECT_EQ(chosen(2, {.method = DirectIntegrator{.emitter_samples = 0}}), EMITTER_AREA);
  EXPECT_EQ(chosen(2, {.method = PathIntegrator{.direct_sampling = DirectSampling::kBsdfOnly}}),
            EMITTER_AREA);
}

}  // namespace
}  // namespace penumbra::emitter_sampling_test
