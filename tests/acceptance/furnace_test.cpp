// Closed rooms that emit the same everywhere: the radiance is a geometric series, whatever the strategy.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/acceptance/strategies.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr double kSignificance = 0.01;
constexpr std::uint32_t kSamples = 100'000;
/// A radiance is a sum of a few products in single precision, each rounded by up to 2^-24 of itself.
constexpr double kRounding = 32.0 / (1 << 24);

/// A furnace of the project's scenes, seen by one pixel.
SceneDescription one_pixel(const char* file, const IntegratorSettings& integrator,
                           const std::vector<std::pair<std::string, std::string>>& defines = {}) {
  SceneDescription scene = read_or_throw(project_file("scenes/furnace") / file, defines);
  resize_film(scene, 1, 1);
  scene.sampler = {.kind = SamplerKind::kIndependent, .spp = kSamples, .seed = 1};
  scene.integrator = integrator;
  return scene;
}

SceneDescription furnace(const char* albedo, const IntegratorSettings& integrator) {
  return one_pixel("furnace.xml", integrator, {{"albedo", albedo}});
}

TestDevice big_passes() {
  TestDevice device = native_device();
  device.samples_per_pass = kMaxSamplesPerUnit;
  return device;
}

void expect_radiance(const SceneDescription& scene, double expected) {
  const FilmAccumulator film = render_or_throw(scene, big_passes());
  EXPECT_EQ(film.nan().count + film.infinite().count, 0u);
  for (int channel = 0; channel < 3; ++channel) {
    const statistics::Sample sample = pixel_sample(film, 0, 0, channel);
    ASSERT_EQ(sample.count(), kSamples);
    EXPECT_GT(statistics::t_test(sample, expected, expected * kRounding).p, kSignificance)
        << "channel " << channel << ": " << sample.mean() << " +- " << sample.standard_error()
        << ", expected " << expected;
  }
}

class DirectFurnace : public testing::TestWithParam<Strategy> {};

TEST_P(DirectFurnace, OneBounceAddsTheAlbedo) {
  expect_radiance(furnace("0.5", GetParam().integrator), 1.5);
  expect_radiance(furnace("0.8", GetParam().integrator), 1.8);
}

INSTANTIATE_TEST_SUITE_P(Strategies, DirectFurnace, testing::ValuesIn(direct_strategies()),
                         [](const auto& info) { return strategy_name(info); });

class PathFurnace : public testing::TestWithParam<Strategy> {};

TEST_P(PathFurnace, AllBouncesAddUp) {
  expect_radiance(furnace("0.5", GetParam().integrator), 2);
  expect_radiance(furnace("0.8", GetParam().integrator), 5);
}

TEST_P(PathFurnace, DepthLimitCutsTheSeries) {
  for (int depth = 1; depth <= 6; ++depth) {
    IntegratorSettings integrator = GetParam().integrator;
    integrator.max_depth = depth;
    SCOPED_TRACE(depth);
    expect_radiance(furnace("0.5", integrator), 2 * (1 - std::pow(0.5, depth)));
  }
}

TEST_P(PathFurnace, EarlyRouletteChangesNothing) {
  IntegratorSettings integrator = GetParam().integrator;
  integrator.rr_depth = 1;
  expect_radiance(furnace("0.8", integrator), 5);
}

TEST_P(PathFurnace, UnitSphereSeenFromInside) {
  const SceneDescription scene = one_pixel("unit-sphere.xml", GetParam().integrator);
  const statistics::Sample sample = pixel_sample(render_or_throw(scene, big_passes()), 0, 0, 0);
  EXPECT_NEAR(sample.mean(), 1, 4 * sample.standard_error() + kRounding);
}

INSTANTIATE_TEST_SUITE_P(Strategies, PathFurnace, testing::ValuesIn(path_strategies()),
                         [](const auto& info) { return strategy_name(info); });

}  // namespace
}  // namespace penumbra
