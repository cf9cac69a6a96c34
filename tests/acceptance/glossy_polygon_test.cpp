// Rough conductors under polygon lights. Control variates and light sampling by control lobes have the same
// mean as paths that sample lights by solid angle and directions by the BSDF, for any alpha, roughness and
// distribution, and less variance where the lobe matters.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tests/acceptance/glossy_room.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr int kWidth = 24, kHeight = 16, kBlock = 4;
constexpr double kBlocks = double(kWidth / kBlock) * (kHeight / kBlock);

/// For estimates of so many batches each. The channels of a block go together: the mean of z^2 has the
/// deviation of as many values as there are blocks, which are of Student's distribution, since the batches
/// say how much they vary: its square has the mean n / (n - 2) and the variance 2 n^2 (n - 1) / ((n - 2)^2
/// (n - 4)).
statistics::ImageTestLimits limits(int batches, int other_batches) {
  const double n = batches + other_batches - 2, mean = n / (n - 2);
  const double variance = 2 * mean * mean * (n - 1) / (n - 4);
  return {.accepted_fraction = 1, .mean_square = mean + 4 * std::sqrt(variance / kBlocks)};
}

SceneDescription room_of(const BsdfModel& floor) {
  SceneDescription scene = glossy_room(floor, kWidth, kHeight);
  scene.sampler.kind = SamplerKind::kSobol;
  scene.sampler.spp = 128;
  return scene;
}

BsdfModel rough_plastic(float alpha, int distribution) {
  RoughPlasticBsdf bsdf;
  bsdf.diffuse = glm::vec3(0.2f, 0.4f, 0.6f);
  bsdf.distribution = distribution;
  bsdf.alpha = alpha;
  return bsdf;
}

/// With all that the control lobes leave out.
BsdfModel principled(float metallic, float roughness, float transmits = 0) {
  PrincipledBsdf bsdf;
  bsdf.base_color = glm::vec3(0.7f, 0.5f, 0.2f);
  bsdf.metallic = metallic;
  bsdf.roughness = roughness;
  bsdf.spec_trans = transmits;
  bsdf.anisotropic = 0.3f;
  bsdf.spec_tint = 0.5f;
  bsdf.sheen = 0.5f;
  bsdf.flatness = 0.3f;
  bsdf.clearcoat = 0.7f;
  bsdf.clearcoat_gloss = 0.2f;
  return bsdf;
}
BsdfModel disney() {
  DisneyBsdf bsdf;
  bsdf.base_color = glm::vec3(0.7f, 0.5f, 0.2f);
  bsdf.roughness = 0.4f;
  bsdf.metallic = 0.3f;
  bsdf.sheen = 0.5f;
  bsdf.clearcoat = 0.5f;
  bsdf.clearcoat_gloss = 0.2f;
  return bsdf;
}

struct Variant {
  std::string name;
  BsdfModel bsdf;
  std::optional<float> alpha;
  EmitterSampling sampling = EmitterSampling::kSolidAngle;
};
void PrintTo(const Variant& variant, std::ostream* out) { *out << variant.name; }

std::vector<Variant> variants() {
  using enum EmitterSampling;
  const BsdfModel rough = rough_conductor(0.3f, DISTRIBUTION_GGX),
                  shiny = rough_conductor(0.05f, DISTRIBUTION_GGX),
                  beckmann = rough_conductor(0.2f, DISTRIBUTION_BECKMANN);
  return {{"MinusOne", rough, -1.0f},
          {"Zero", rough, 0.0f},
          {"Half", rough, 0.5f},
          {"One", rough, 1.0f},
          {"Fitted", rough, std::nullopt},
          {"OneByProjection", rough, 1.0f, kProjected},
          {"FittedByProjection", rough, std::nullopt, kProjected},
          {"ShinyMinusOneByProjection", shiny, -1.0f, kProjected},
          {"ShinyHalfByProjection", shiny, 0.5f, kProjected},
          {"ShinyOneByProjection", shiny, 1.0f, kProjected},
          {"BeckmannMinusOne", beckmann, -1.0f},
          {"BeckmannOne", beckmann, 1.0f},
          {"BeckmannFitted", beckmann, std::nullopt},
          {"BeckmannOneByProjection", beckmann, 1.0f, kProjected},
          {"Roughest", rough_conductor(1.0f, DISTRIBUTION_GGX), 1.0f},
          {"Plastic", PlasticBsdf{.diffuse = glm::vec3(0.6f, 0.3f, 0.1f)}, 1.0f},
          {"RoughPlastic", rough_plastic(0.15f, DISTRIBUTION_GGX), 1.0f},
          {"RoughPlasticMinusOne", rough_plastic(0.3f, DISTRIBUTION_BECKMANN), -1.0f},
          {"RoughPlasticFitted", rough_plastic(0.3f, DISTRIBUTION_BECKMANN), std::nullopt},
          {"RoughPlasticByProjection", rough_plastic(0.05f, DISTRIBUTION_GGX), 1.0f, kProjected},
          {"MicrofacetByProjection", MicrofacetDiffuseBsdf{.diffuse = glm::vec3(0.4f)}, 1.0f, kProjected},
          {"Principled", principled(0, 0.4f), 1.0f},
          {"PrincipledMinusOne", principled(0.5f, 0.6f), -1.0f},
          {"PrincipledByProjection", principled(0.5f, 0.3f), 1.0f, kProjected},
          {"PrincipledFitted", principled(1, 0.5f), std::nullopt},
          {"PrincipledGlass", principled(0, 0.5f, 0.5f), 1.0f},
          {"Disney", disney(), 1.0f},
          {"DisneyByProjection", disney(), 0.5f, kProjected},
          {"Anisotropic", rough_conductor(0.1f, DISTRIBUTION_GGX, 0.4f), 1.0f},
          {"AnisotropicByProjection", rough_conductor(0.4f, DISTRIBUTION_BECKMANN, 0.1f), 1.0f, kProjected}};
}

std::vector<Variant> projected_variants() {
  std::vector<Variant> all = variants();
  std::erase_if(all, [](const Variant& v) { return v.sampling != EmitterSampling::kProjected; });
  return all;
}

class GlossyPolygons : public testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, GlossyPolygons, testing::ValuesIn(variants()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(GlossyPolygons, PathsHaveTheMeanOfPaths) {
  SceneDescription scene = room_of(GetParam().bsdf);
  use(scene.integrator, IntegratorKind::kPath);
  param::max_depth(scene.integrator) = 4;
  const statistics::Estimate paths = block_estimate(scene, 16, 100, kBlock);
  param::next_event(scene.integrator) = NextEvent::kCv;
  param::alpha(scene.integrator) = GetParam().alpha;
  param::emitter_sampling(scene.integrator) = GetParam().sampling;
  const auto result = statistics::z_test(paths, block_estimate(scene, 16, 200, kBlock), limits(16, 16));
  EXPECT_TRUE(result.passed) << result.summary();
}

TEST_P(GlossyPolygons, DirectLightHasTheMeanOfDirectLight) {
  SceneDescription scene = room_of(GetParam().bsdf);
  // Control variates belong to samples of lights, which no mirror has.
  scene.integrator = direct_integrator(1, std::holds_alternative<PlasticBsdf>(GetParam().bsdf) ? 0 : 1);
  const statistics::Estimate direct = block_estimate(scene, 8, 300, kBlock);
  use(scene.integrator, IntegratorKind::kPolygonCv);
  param::alpha(scene.integrator) = GetParam().alpha;
  param::emitter_sampling(scene.integrator) = GetParam().sampling;
  const auto result = statistics::z_test(direct, block_estimate(scene, 8, 400, kBlock), limits(8, 8));
  EXPECT_TRUE(result.passed) << result.summary();
}

class GlossyPolygonSamples : public testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, GlossyPolygonSamples, testing::ValuesIn(projected_variants()),
                         [](const auto& tested) { return tested.param.name; });

// The density that directions of the BSDF are told is that with which lights are sampled.
TEST_P(GlossyPolygonSamples, HaveTheMeanOfPaths) {
  SceneDescription scene = room_of(GetParam().bsdf);
  use(scene.integrator, IntegratorKind::kPath);
  param::max_depth(scene.integrator) = 4;
  const statistics::Estimate paths = block_estimate(scene, 8, 500, kBlock);
  param::emitter_sampling(scene.integrator) = EmitterSampling::kProjected;
  const auto balanced = statistics::z_test(paths, block_estimate(scene, 8, 600, kBlock), limits(8, 8));
  EXPECT_TRUE(balanced.passed) << balanced.summary();
}

/// Of single samples of two rays each.
double variance_of(SceneDescription scene, const IntegratorSettings& integrator) {
  scene.sampler.kind = SamplerKind::kIndependent;
  scene.integrator = integrator;
  scene.integrator.hide_emitters = true;
  return mean_variance(render_or_throw(scene));
}

// See the table in kernels/MEASUREMENTS.md: here about 18, 45 and 45 times.
TEST(GlossyPolygonVariance, IsAFractionWithTheLobes) {
  const SceneDescription scene = room_of(rough_conductor(0.1f, DISTRIBUTION_GGX));
  IntegratorSettings lights = direct_integrator(2, 0);
  param::light_choice(lights) = LightChoice::kAnalytic;
  param::emitter_sampling(lights) = EmitterSampling::kSolidAngle;
  const double by_solid_angle = variance_of(scene, lights);
  param::emitter_sampling(lights) = EmitterSampling::kProjected;
  EXPECT_LT(variance_of(scene, lights), by_solid_angle / 8);
  const double balanced = variance_of(scene, direct_integrator(1, 1));
  IntegratorSettings control;
  use(control, IntegratorKind::kPolygonCv);
  param::vis_samples(control) = 2;
  for (const std::optional<float> alpha : {std::optional(1.0f), std::optional<float>()}) {
    param::alpha(control) = alpha;
    EXPECT_LT(variance_of(scene, control), balanced / 16);
  }
}

}  // namespace
}  // namespace penumbra
