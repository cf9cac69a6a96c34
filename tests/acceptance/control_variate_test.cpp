// Shadowed polygon lights with their closed form as control variate, on one receiver: the noise of each
// estimator (the table of ALGORITHMS.md, section 2), no bias for any alpha, and no noise where the variance
// is 0.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

using glm::dvec3;

constexpr double kSignificance = 0.01;
constexpr double kRounding = 32.0 / (1 << 24);  ///< relative; see furnace_test.cpp
constexpr float kAlbedo = 0.5f;
const dvec3 kViewer(0, 0.01, 0);
const dvec3 kSlantedViewer(-0.003, 0.01, 0.001);  ///< its mirror direction meets the 68 % edge of the light

double radiance(const PolygonPoints& polygon) {
  return kAlbedo / std::numbers::pi * projected_solid_angle(polygon);
}

// --- the truth itself

TEST(ShadowedPolygon, TruthsAgree) {
  const ShadowedPolygon bare = large_light();
  const double whole = projected_solid_angle(bare.light);
  EXPECT_NEAR(whole, 2.137964861, 1e-9);
  EXPECT_NEAR(projected_solid_angle(large_light(kEdge68).visible()), 0.68 * whole, 1e-8);
  EXPECT_NEAR(projected_solid_angle(large_light(kEdge24).visible()), 0.24 * whole, 1e-8);
  EXPECT_TRUE(large_light(kEdgeUmbra).visible().empty());
  EXPECT_NEAR(projected_solid_angle(small_light().visible()),
              0.43 * projected_solid_angle(small_light().light), 1e-7);
  for (const ShadowedPolygon& light : {bare, large_light(kEdge68), large_light(kEdge24), small_light()})
    EXPECT_NEAR(reflected_radiance(light.visible(), DiffuseBsdf{glm::vec3(kAlbedo)}, kViewer),
                radiance(light.visible()), 1e-10);
  // Under a light that covers its whole lobe a normalised lobe reflects everything towards a viewer along
  // the normal. What (1 - cos^(n + 2)) leaves out at 45 degrees is 1e-151.
  const PolygonPoints above{{-1, 1, 1}, {-1, 1, -1}, {1, 1, -1}, {1, 1, 1}};
  EXPECT_NEAR(reflected_radiance(above, PhongBsdf{glm::vec3(0), glm::vec3(1), 1000}, kViewer), 1, 1e-7);
}

// --- the table

/// Root of the mean square error of a camera sample with 16 shadow rays, relative to the unshadowed radiance.
/// Of 128^2 the RMSE is known within about 1 %.
double relative_rmse(const ShadowedPolygon& light, const IntegratorSettings& integrator, std::uint32_t seed,
                     int pixels = 128, statistics::Sample* of_all = nullptr) {
  SceneDescription scene = receiver_scene(DiffuseBsdf{glm::vec3(kAlbedo)}, kViewer, pixels, seed);
  add_light(scene, light, glm::vec3(1));
  scene.integrator = integrator;
  const statistics::Sample sample = pass_means(scene, 1);
  const double unshadowed = radiance(light.light), deviation = sample.mean() - radiance(light.visible());
  if (of_all) *of_all = sample;
  return std::sqrt(sample.variance() + deviation * deviation) / unshadowed;
}

constexpr int kRays = 16;
constexpr double kTableTolerance = 0.15;

struct TableRow {
  std::string name;
  ShadowedPolygon light;
  double alpha_star;
  // What is expected.
  double plain, alpha_1, best_alpha, solid_angle, projected;
};

void PrintTo(const TableRow& row, std::ostream* out) { *out << row.name; }

class NoiseTable : public testing::TestWithParam<TableRow> {};

TEST_P(NoiseTable, IsAsPublished) {
  const TableRow& row = GetParam();
  using enum EmitterSampling;
  IntegratorSettings plain = emitter_only(kArea, kRays);
  use(plain, IntegratorKind::kPolygonArea);
  std::uint32_t seed = 1;
  const auto check = [&](const char* column, const IntegratorSettings& integrator, double expected) {
    const double rmse = relative_rmse(row.light, integrator, seed++);
    EXPECT_NEAR(rmse, expected, expected > 0 ? kTableTolerance * expected : kRounding) << column;
    testing::Test::RecordProperty(column, std::to_string(rmse));
  };
  check("polygon_area", plain, row.plain);
  check("direct_by_area", emitter_only(kArea, kRays), row.plain);
  check("alpha_1", polygon_cv(1.0f, kArea, kRays), row.alpha_1);
  check("best_alpha", polygon_cv(float(row.alpha_star), kArea, kRays), row.best_alpha);
  check("solid_angle", emitter_only(kSolidAngle, kRays), row.solid_angle);
  // The quadrilateral is two triangles: only the choice by contribution makes them one light.
  check("projected", emitter_only(kProjected, kRays, LightChoice::kAnalytic), row.projected);
}

INSTANTIATE_TEST_SUITE_P(
    Rows, NoiseTable,
    testing::Values(TableRow{"FullyLit", large_light(), 1, .228, 0, 0, .044, 0},
                    TableRow{"Visible68", large_light(kEdge68), .630, .218, .182, .162, .131, .117},
                    TableRow{"Visible24", large_light(kEdge24), -.072, .087, .261, .086, .105, .107},
                    TableRow{"Umbra", large_light(kEdgeUmbra), 0, 0, .23, 0, 0, 0},
                    TableRow{"SmallLight43", small_light(), -1.83, .1089, .1438, .0742, .1196, .1238}),
    [](const auto& tested) { return tested.param.name; });

// --- no bias

struct BiasCase {
  std::string name;
  BsdfModel bsdf;
  ShadowedPolygon light;
  int samples;  ///< camera samples of each case
  std::vector<int> rays{1, 4}, passes{1, 2, 3, 8, 16};
};

void PrintTo(const BiasCase& tested, std::ostream* out) { *out << tested.name; }

class NoBias : public testing::TestWithParam<BiasCase> {};

TEST_P(NoBias, WhateverAlphaSamplingAndPass) {
  const BiasCase& tested = GetParam();
  const double truth = reflected_radiance(tested.light.visible(), tested.bsdf, kSlantedViewer);
  ManyTests tests;
  std::uint32_t seed = 1000;
  using enum EmitterSampling;
  for (EmitterSampling sampling : {kArea, kSolidAngle, kProjected})
    for (std::optional<float> alpha : {std::optional(-2.0f), std::optional(0.0f), std::optional(0.5f),
                                       std::optional(1.0f), std::optional(2.0f), std::optional<float>()})
      for (int rays : tested.rays)
        for (int pass : tested.passes) {
          const int pixels = std::max(16, int(std::sqrt(double(tested.samples) / pass)));
          SceneDescription scene = receiver_scene(tested.bsdf, kSlantedViewer, pixels, seed++);
          add_light(scene, tested.light, glm::vec3(1));
          scene.integrator = polygon_cv(alpha, sampling, rays);
          const statistics::Sample sample = pass_means(scene, std::uint32_t(pass));
          ASSERT_EQ(sample.count(), std::uint64_t(pixels) * std::uint64_t(pixels));
          tests.add(statistics::t_test(sample, truth, kRounding * truth),
                    "alpha " + (alpha ? std::to_string(*alpha) : "auto") + ", sampling " +
                        std::to_string(int(sampling)) + ", " + std::to_string(rays) + " rays, passes of " +
                        std::to_string(pass));
        }
  tests.expect_passed(kSignificance);
}

const PhongBsdf kGlossy{glm::vec3(0.3f), glm::vec3(0.4f), 10};
const PhongBsdf kShiny{glm::vec3(0.3f), glm::vec3(0.4f), 1000};

INSTANTIATE_TEST_SUITE_P(
    Cases, NoBias,
    testing::Values(BiasCase{"Diffuse68", DiffuseBsdf{glm::vec3(kAlbedo)}, large_light(kEdge68), 16384},
                    BiasCase{"Diffuse24", DiffuseBsdf{glm::vec3(kAlbedo)}, large_light(kEdge24), 16384},
                    BiasCase{"DiffuseSmallLight", DiffuseBsdf{glm::vec3(kAlbedo)}, small_light(), 16384},
                    BiasCase{"Phong10", kGlossy, large_light(kEdge68), 16384},
                    // One ray in 500 finds the lobe: 2000 must for their mean to be normally distributed.
                    BiasCase{"Phong1000", kShiny, large_light(kEdge68), 65536, {16}, {3, 8}}),
    [](const auto& tested) { return tested.param.name; });

// --- no noise

struct Receiver {
  const char* name;
  BsdfModel bsdf;
};
const Receiver kReceivers[] = {
    {"diffuse", DiffuseBsdf{glm::vec3(kAlbedo)}}, {"Phong 10", kGlossy}, {"Phong 1000", kShiny}};

TEST(NoNoise, FullyLitWithAlpha1) {
  for (const Receiver& receiver : kReceivers)
    for (EmitterSampling sampling :
         {EmitterSampling::kArea, EmitterSampling::kSolidAngle, EmitterSampling::kProjected})
      for (int rays : {1, 4}) {
        SceneDescription scene = receiver_scene(receiver.bsdf, kSlantedViewer, 32, 7);
        add_light(scene, large_light(), glm::vec3(1));
        scene.integrator = polygon_cv(1.0f, sampling, rays);
        const statistics::Sample sample = pass_means(scene, 4);
        const double truth = reflected_radiance(large_light().light, receiver.bsdf, kSlantedViewer);
        EXPECT_NEAR(sample.mean(), truth, kRounding * truth) << receiver.name;
        EXPECT_LT(std::sqrt(4 * sample.variance()), 1e-6 * truth) << receiver.name;
      }
}

TEST(NoNoise, FullyLitWithAFittedAlpha) {
  // The guess, the share of the light that is seen, is exactly 1; passes of one sample have none to fit to.
  SceneDescription scene = receiver_scene(kGlossy, kSlantedViewer, 32, 7);
  add_light(scene, large_light(), glm::vec3(1));
  scene.integrator = polygon_cv(std::nullopt, EmitterSampling::kArea, 4);
  const double truth = reflected_radiance(large_light().light, kGlossy, kSlantedViewer);
  const statistics::Sample sample = pass_means(scene, 8);
  EXPECT_NEAR(sample.mean(), truth, kRounding * truth);
  EXPECT_LT(std::sqrt(8 * sample.variance()), 1e-6 * truth);
}

TEST(NoNoise, Umbra) {
  using enum EmitterSampling;
  const IntegratorSettings integrators[] = {
      polygon_cv(std::nullopt, kArea, 4), polygon_cv(std::nullopt, kSolidAngle, 4),
      polygon_cv(std::nullopt, kProjected, 1), emitter_only(kProjected, 4),
      emitter_only(kArea, 4, LightChoice::kAnalytic)};
  for (const Receiver& receiver : kReceivers)
    for (const IntegratorSettings& integrator : integrators)
      for (std::uint32_t pass : {1u, 2u, 7u, 16u}) {
        SceneDescription scene = receiver_scene(receiver.bsdf, kSlantedViewer, 16, 7);
        add_light(scene, large_light(kEdgeUmbra), glm::vec3(1));
        scene.integrator = integrator;
        scene.sampler.spp = pass;
        TestDevice device = native_device();
        device.samples_per_pass = pass;
        const FilmAccumulator film = render_or_throw(scene, device);
        for (int x = 0; x < film.width(); ++x) {
          EXPECT_EQ(film.at(x, x).mean[1], 0) << receiver.name;
          EXPECT_EQ(film.at(x, x).m2[1], 0) << receiver.name;
        }
      }
}

TEST(NoNoise, ProjectedSolidAngleOfOneColour) {
  // Two lights on a diffuse surface: a choice by contribution and directions by projected solid angle leave
  // nothing to chance but the shadows.
  SceneDescription scene = receiver_scene(DiffuseBsdf{glm::vec3(kAlbedo)}, kViewer, 32, 7);
  const ShadowedPolygon left{{{-2, 1, 0.5}, {-2, 1, -0.5}, {-1.5, 1.5, -0.5}, {-1.5, 1.5, 0.5}}};
  const ShadowedPolygon right{{{0.5, 2, 0.5}, {0.5, 2, -0.1}, {2.5, 1, -0.5}}};
  add_light(scene, left, glm::vec3(2));
  add_light(scene, right, glm::vec3(0.5f));
  scene.integrator = emitter_only(EmitterSampling::kProjected, 1, LightChoice::kAnalytic);
  const double truth = 2 * radiance(left.light) + 0.5 * radiance(right.light);
  const statistics::Sample sample = pass_means(scene, 1);
  EXPECT_NEAR(sample.mean(), truth, kRounding * truth);
  EXPECT_LT(std::sqrt(sample.variance()), 1e-6 * truth);
  param::light_choice(scene.integrator) = LightChoice::kPower;
  EXPECT_GT(std::sqrt(pass_means(scene, 1).variance()), 0.1 * truth);
}

}  // namespace
}  // namespace penumbra
