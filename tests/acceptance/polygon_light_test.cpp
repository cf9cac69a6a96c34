// A diffuse floor under one triangle light: five exact pixel values, which every strategy must give.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "tests/acceptance/strategies.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra::polygon_light_test {
namespace {

constexpr double kSignificance = 0.01;
constexpr std::uint32_t kSamples = 100'000;
constexpr double kRounding = 32.0 / (1 << 24);  ///< see furnace_test.cpp

/// Radiance of the floor at the origin under each of the lights of scenes/polygon-lights.
constexpr std::array kRadiance{0.089839259, 0.022920040, 0.053419540, 0.020531391, 0.261739859};

/// A diffuse receiver that sees all of a light by its projected solid angle has no variance.
bool has_no_variance(const IntegratorSettings& integrator) {
  return kind_of(integrator) == IntegratorKind::kDirect && param::bsdf_samples(integrator) == 0 &&
         param::emitter_sampling(integrator) == EmitterSampling::kProjected;
}

class PolygonLights : public testing::TestWithParam<Strategy> {};

TEST_P(PolygonLights, ExactRadiance) {
  TestDevice device = native_device();
  device.samples_per_pass = kMaxSamplesPerUnit;
  for (std::size_t i = 0; i < kRadiance.size(); ++i) {
    SceneDescription scene = read_or_throw(project_file("scenes/polygon-lights/polygon-lights.xml"),
                                           {{"light", std::to_string(i + 1)}});
    scene.sampler = {.kind = SamplerKind::kIndependent, .spp = kSamples, .seed = 1};
    scene.integrator = GetParam().integrator;
    const FilmAccumulator film = render_or_throw(scene, device);
    const statistics::Sample sample = pixel_sample(film, 0, 0, 1);
    ASSERT_EQ(sample.count(), kSamples);
    if (!has_no_variance(GetParam().integrator)) EXPECT_GT(sample.standard_error(), 0);
    EXPECT_GT(statistics::t_test(sample, kRadiance[i], kRadiance[i] * kRounding).p, kSignificance)
        << "light " << i + 1 << ": " << sample.mean() << " +- " << sample.standard_error() << ", exactly "
        << kRadiance[i];
  }
}

TEST(PolygonLightsProjected, EverySampleIsExact) {
  TestDevice device = native_device();
  for (std::size_t i = 0; i < kRadiance.size(); ++i) {
    SceneDescription scene = read_or_throw(project_file("scenes/polygon-lights/polygon-lights.xml"),
                                           {{"light", std::to_string(i + 1)}});
    scene.sampler = {.kind = SamplerKind::kIndependent, .spp = 1000, .seed = 1};
    scene.integrator = direct_integrator(1, 0);
    param::emitter_sampling(scene.integrator) = EmitterSampling::kProjected;
    const FilmAccumulator film = render_or_throw(build_or_throw(scene), device);
    const statistics::Sample sample = pixel_sample(film, 0, 0, 1);
    EXPECT_NEAR(sample.mean(), kRadiance[i], 1e-5 * kRadiance[i]) << "light " << i + 1;
    EXPECT_LT(std::sqrt(sample.variance()), 1e-5 * kRadiance[i]) << "light " << i + 1;
  }
}

INSTANTIATE_TEST_SUITE_P(Strategies, PolygonLights, testing::ValuesIn(all_strategies()),
                         [](const auto& info) { return strategy_name(info); });

}  // namespace
}  // namespace penumbra::polygon_light_test
