// Furnaces: closed rooms that emit the same everywhere. The radiance is a geometric series, for every
// strategy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/acceptance/strategies.h"
#include "tests/support/integrator_parameters.h"
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
  EXPECT_EQ(non_finite_count(film.flagged()), 0u);
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
    param::max_depth(integrator) = depth;
    SCOPED_TRACE(depth);
    expect_radiance(furnace("0.5", integrator), 2 * (1 - std::pow(0.5, depth)));
  }
}

TEST_P(PathFurnace, EarlyRouletteChangesNothing) {
  IntegratorSettings integrator = GetParam().integrator;
  param::rr_depth(integrator) = 1;
  expect_radiance(furnace("0.8", integrator), 5);
}

/// Mean, variance and fourth central moment of a sample where every surface emits 1, reflects `albedo` and
/// only directions are sampled: a path that sees n + 1 surfaces adds its throughputs up to there, which
/// depend on n alone, and ends there with a known probability.
struct Moments {
  double mean = 0, variance = 0, fourth = 0;
};

Moments roulette_moments(double albedo, int rr_depth) {
  std::vector<std::pair<double, double>> ends;  // probability, sum
  double alive = 1, throughput = 1, sum = 0;
  for (int step = 0; alive > 1e-15; ++step) {
    sum += throughput;
    throughput *= albedo;
    const int k = step + 1 - rr_depth;
    const double survival = k < 0 ? 1 : std::min(std::sqrt(2 * throughput), 1 - 2 / (k + 100.0));
    ends.emplace_back(alive * (1 - survival), sum);
    alive *= survival;
    throughput /= survival;
  }
  Moments moments;
  for (const auto& [p, s] : ends) moments.mean += p * s;
  for (const auto& [p, s] : ends) {
    moments.variance += p * std::pow(s - moments.mean, 2);
    moments.fourth += p * std::pow(s - moments.mean, 4);
  }
  return moments;
}

TEST(Roulette, VarianceIsThatOfItsProbabilitiesUpToAlbedo099) {
  for (const char* albedo : {"0.5", "0.8", "0.97", "0.99"}) {
    const PathIntegrator path{.direct_sampling = DirectSampling::kBsdfOnly};
    const IntegratorSettings integrator{.method = path};
    const Moments moments = roulette_moments(std::stod(albedo), path.rr_depth);
    EXPECT_NEAR(moments.mean * (1 - std::stod(albedo)), 1, 1e-9) << albedo;
    EXPECT_LT(moments.variance, 8 * moments.mean * moments.mean) << albedo;  // finite, and small
    const FilmAccumulator film = render_or_throw(furnace(albedo, integrator), big_passes());
    const statistics::Sample sample = pixel_sample(film, 0, 0, 0);
    const double n = double(sample.count());
    EXPECT_NEAR(sample.mean(), moments.mean, 4 * std::sqrt(moments.variance / n)) << albedo;
    const double deviation = std::sqrt((moments.fourth - moments.variance * moments.variance) / n);
    EXPECT_NEAR(n * sample.standard_error() * sample.standard_error(), moments.variance, 4 * deviation)
        << albedo;
  }
}

TEST(Roulette, EndsPathsThatLoseNothing) {
  SceneDescription scene = furnace("1", {.method = PathIntegrator{}});
  scene.sampler.spp = 2000;
  const FilmAccumulator film = render_or_throw(scene, big_passes());
  EXPECT_EQ(non_finite_count(film.flagged()), 0u);
}

TEST_P(PathFurnace, UnitSphereSeenFromInside) {
  const SceneDescription scene = one_pixel("unit-sphere.xml", GetParam().integrator);
  const statistics::Sample sample = pixel_sample(render_or_throw(scene, big_passes()), 0, 0, 0);
  EXPECT_NEAR(sample.mean(), 1, 4 * sample.standard_error() + kRounding);
}

/// A straight strand fills the pixel, before a uniform sky: fibres that absorb nothing are as bright.
TEST(HairFurnace, StrandsOfEveryFormThatAbsorbNothingAreUnseen) {
  for (const CurveForm form :
       {CurveForm::kRound, CurveForm::kBalls, CurveForm::kFlat, CurveForm::kCylinder}) {
    SceneDescription scene = furnace("0.5", {.method = PathIntegrator{}});
    Curves strand{form, {{}}, {}};
    for (int i = 0; i < 6; ++i) strand.curves[0].push_back({{0.15, 4.0 * i - 10, 1}, 0.5});
    HairBsdf hair;
    hair.absorption = HairBsdf::Absorption::kCoefficient;
    hair.offset = is_ribbon(form) ? HairBsdf::kFromV : HairBsdf::kFromNormal;
    scene.bsdfs = {Bsdf{"hair", hair}};
    Shape shape;
    shape.name = "strand";
    shape.geometry = std::move(strand);
    shape.front_bsdf = shape.back_bsdf = 0;
    scene.shapes = {std::move(shape)};
    scene.emitters = {ConstantEnvironment{}};
    SCOPED_TRACE(int(form));
    // The Bessel function of the lobes is within 1e-6 of itself.
    const FilmAccumulator film = render_or_throw(scene, big_passes());
    EXPECT_EQ(non_finite_count(film.flagged()), 0u);
    const statistics::Sample sample = pixel_sample(film, 0, 0, 0);
    EXPECT_GT(statistics::t_test(sample, 1, 1e-6 + kRounding).p, kSignificance)
        << sample.mean() << " +- " << sample.standard_error();
    // It is seen: light comes by scattering, which varies.
    EXPECT_GT(sample.standard_error(), 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(Strategies, PathFurnace, testing::ValuesIn(path_strategies()),
                         [](const auto& info) { return strategy_name(info); });

}  // namespace
}  // namespace penumbra
