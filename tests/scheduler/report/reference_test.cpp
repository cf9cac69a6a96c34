#include "scheduler/report/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "scheduler/report/reference_choice.h"
#include "scheduler/report/sampler_orders.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

Image grey_noise(double mean, double sd, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Image image{{0, 0, 50, 50}, {0, 0, 50, 50}, {"Y"}, {}, {}};
  for (int i = 0; i < 2500; ++i) image.values.push_back(float(mean + sd * normal(random)));
  return image;
}

TEST(ReferenceHalves, AgreeOrDoNot) {
  constexpr double kDeviations = 4;
  EXPECT_LT(std::abs(halves_z(grey_noise(1, 0.1, 1), grey_noise(1, 0.2, 2))), kDeviations);
  // The mean of 2500 differences has the standard deviation sqrt(0.05) / 50 = 0.00447.
  EXPECT_NEAR(halves_z(grey_noise(1.1, 0.1, 1), grey_noise(1, 0.2, 2)), 0.1 / 0.00447, kDeviations);
  EXPECT_EQ(halves_z(grey_noise(1, 0.1, 1), grey_noise(1, 0.1, 1)), 0);
}

TEST(ReferenceNoise, IsTheMeanOfItsVariance) {
  const Image image{{0, 0, 1, 2},
                    {0, 0, 1, 2},
                    {"R", "G", "B", "variance.R", "variance.G", "variance.B"},
                    {2, 2, 2, 0.5f, 0.5f, 0.5f, 0, 0, 0, 0.25f, 0.25f, 0.25f},
                    {}};
  const auto noise = reference_noise(image, 1);
  ASSERT_TRUE(noise);
  EXPECT_NEAR(noise->mse, 0.375, 1e-12);
  EXPECT_NEAR(noise->relmse, (0.5 / 5 + 0.25) / 2, 1e-12);
  EXPECT_FALSE(reference_noise(grey_noise(1, 1, 1), 1));
}

TEST(ReferenceChoice, EstimatesTheSameByOtherMeans) {
  IntegratorSettings direct;
  use(direct, IntegratorKind::kDirect);
  IntegratorSettings cv;
  use(cv, IntegratorKind::kPolygonCv);
  IntegratorSettings two_edges;
  param::max_depth(two_edges) = 2;
  EXPECT_EQ(estimated_quantity(direct), estimated_quantity(cv));
  EXPECT_EQ(estimated_quantity(direct), estimated_quantity(two_edges));
  const auto halves = choose_reference(cv);
  EXPECT_EQ(halves[0].integrator, "path_mis");
  EXPECT_EQ(halves[1].integrator, "direct");

  IntegratorSettings unshadowed;
  use(unshadowed, IntegratorKind::kPolygonArea);
  param::trace_shadows(unshadowed) = false;
  IntegratorSettings analytic;
  use(analytic, IntegratorKind::kPolygonAnalytic);
  EXPECT_EQ(estimated_quantity(unshadowed), estimated_quantity(analytic));
  EXPECT_NE(estimated_quantity(unshadowed), estimated_quantity(cv));

  IntegratorSettings path;
  EXPECT_NE(estimated_quantity(path), estimated_quantity(direct));
  IntegratorSettings hidden = path;
  hidden.hide_emitters = true;
  EXPECT_NE(estimated_quantity(path), estimated_quantity(hidden));
  IntegratorSettings looked_through = hidden;
  looked_through.hidden_emitters = HiddenEmitters::kLookedThrough;
  EXPECT_NE(estimated_quantity(hidden), estimated_quantity(looked_through));
  for (const auto& half : choose_reference(looked_through))
    EXPECT_NE(std::ranges::find(half.settings, "integrator.hidden_emitters=looked_through"),
              half.settings.end());
  for (const auto& half : choose_reference(path)) EXPECT_EQ(half.integrator, "path_mis");
  EXPECT_NE(choose_reference(path)[0].sampler, choose_reference(path)[1].sampler);
}

TEST(ReferenceChoice, WhittedIsPathAndWhatNoOtherEstimatesIsItsOwn) {
  IntegratorSettings path, whitted;
  param::max_depth(path) = 5;
  whitted = path;
  use(whitted, IntegratorKind::kWhitted);
  EXPECT_EQ(estimated_quantity(path), estimated_quantity(whitted));
  EXPECT_EQ(choose_reference(whitted)[0].integrator, "path_mis");
  param::indirect_samples(whitted) = 0;
  EXPECT_NE(estimated_quantity(path), estimated_quantity(whitted));
  EXPECT_EQ(choose_reference(whitted)[0].integrator, "whitted");
  IntegratorSettings part = path;
  std::get<PathIntegrator>(part.method).only_bounces = 2;
  EXPECT_NE(estimated_quantity(path), estimated_quantity(part));
  const auto parts = choose_reference(part);
  EXPECT_NE(std::ranges::find(parts[0].settings, "integrator.only_bounces=2"), parts[0].settings.end());
  EXPECT_NE(parts[0].sampler, parts[1].sampler);
  IntegratorSettings sooner = part, power = part;
  param::rr_depth(sooner) = 2;
  EXPECT_EQ(estimated_quantity(part), estimated_quantity(sooner));
  param::heuristic(power) = MisHeuristic::kPower;
  EXPECT_NE(estimated_quantity(part), estimated_quantity(power));
  for (const IntegratorKind kind :
       {IntegratorKind::kAmbientOcclusion, IntegratorKind::kReflectionOcclusion}) {
    IntegratorSettings occlusion, longer;
    use(occlusion, kind);
    longer = occlusion;
    param::ray_length(longer) = 3;
    EXPECT_NE(estimated_quantity(occlusion), estimated_quantity(longer));
    const auto halves = choose_reference(longer);
    EXPECT_EQ(halves[0].integrator, method_name(longer.method));
    EXPECT_EQ(halves[0].settings, halves[1].settings);
    EXPECT_NE(halves[0].sampler, halves[1].sampler);
    EXPECT_NE(std::ranges::find(halves[0].settings, "integrator.ray_length=3"), halves[0].settings.end());
    param::vis_samples(longer) = 9;
    IntegratorSettings fewer = longer;
    param::vis_samples(fewer) = 1;
    EXPECT_EQ(estimated_quantity(longer), estimated_quantity(fewer));
  }
}

TEST(ReferenceChoice, PhotonMappingIsJudgedByPathsOrInMediaByVolpath) {
  IntegratorSettings path, volpath;
  use_integrator(volpath, VolpathIntegrator{});
  for (IntegratorMethod method :
       {IntegratorMethod(ProgressivePhotonIntegrator{}), IntegratorMethod(PhotonMapIntegrator{})}) {
    IntegratorSettings photons;
    use_integrator(photons, method);
    SCOPED_TRACE(method_name(method));
    EXPECT_EQ(estimated_quantity(photons, false), estimated_quantity(path, false));
    EXPECT_EQ(estimated_quantity(photons, true), estimated_quantity(volpath, true));
    EXPECT_NE(estimated_quantity(photons, true), estimated_quantity(path, true));
    for (const auto& half : choose_reference(photons, false)) EXPECT_EQ(half.integrator, "path_mis");
    for (const auto& half : choose_reference(photons, true)) EXPECT_EQ(half.integrator, "volpath");
    param::max_depth(photons) = 4;
    param::max_depth(path) = 4;
    EXPECT_EQ(estimated_quantity(photons, false), estimated_quantity(path, false));
    EXPECT_NE(estimated_quantity(photons, true), estimated_quantity(volpath, true));
    const auto halves = choose_reference(photons, true);
    EXPECT_NE(std::ranges::find(halves[1].settings, "integrator.max_depth=4"), halves[1].settings.end());
    EXPECT_NE(halves[0].settings, halves[1].settings);
    param::max_depth(path) = -1;
  }
}

TEST(ReferenceChoice, HasFiftyTimesTheSamples) {
  for (const std::uint32_t largest : {1u, 16u, 64u, 1000u})
    EXPECT_GE(2 * std::uint64_t(half_reference_spp(largest, 0)), kReferenceFactor * largest);
  EXPECT_EQ(half_reference_spp(64, 100), 50u);
  EXPECT_EQ(half_reference_spp(64, 101), 51u);
  EXPECT_LE(half_reference_spp(4000000000u, 0), 1u << 30);
}

TEST(SamplerOrders, AreTwiceThoseOfRmse) {
  EXPECT_EQ(expected_order("independent")->smooth, -1);
  EXPECT_EQ(expected_order("stratified")->smooth, -2);
  EXPECT_EQ(expected_order("sobol")->smooth, -3);
  EXPECT_EQ(expected_order("sobol")->edges, -1.5);
  EXPECT_FALSE(expected_order("mystery"));
}

}  // namespace
}  // namespace penumbra
