// Glossy plates under spheres of several sizes: BSDF sampling, emitter sampling and MIS must agree, and MIS
// must be the least noisy.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr int kWidth = 48, kHeight = 32, kBlock = 4;
constexpr double kBlocks = double(kWidth / kBlock) * (kHeight / kBlock);

/// Two samples in all for each, so that variances compare at equal cost.
const IntegratorSettings kBsdf = direct_integrator(0, 2);
const IntegratorSettings kEmitter = direct_integrator(2, 0);
const IntegratorSettings kMis = direct_integrator(1, 1, MisHeuristic::kBalance);

SceneDescription veach(const IntegratorSettings& integrator, SamplerKind sampler, std::uint32_t spp) {
  SceneDescription scene = read_or_throw(project_file("scenes/veach-mis/veach-mis.xml"));
  resize_film(scene, kWidth, kHeight);
  scene.sampler.kind = sampler;
  scene.sampler.spp = spp;
  scene.integrator = integrator;
  return scene;
}

TEST(VeachScene, StrategiesAgree) {
  // A low-discrepancy sequence and many samples, because emitter samples find the sharpest plate's lobe so
  // rarely that the mean of few independent ones is far from normally distributed.
  const auto estimate = [](const IntegratorSettings& integrator, std::uint32_t spp, std::uint32_t seed) {
    return block_estimate(veach(integrator, SamplerKind::kSobol, spp), 6, seed, kBlock);
  };
  const statistics::Estimate bsdf = estimate(kBsdf, 1024, 100), emitter = estimate(kEmitter, 4096, 200),
                             mis = estimate(kMis, 1024, 300);
  // The channels of a block go together: one block of the 96 may be outside, and the mean of z^2 has the
  // deviation of that many independent values.
  const statistics::ImageTestLimits limits{.accepted_fraction = 1 - 1.5 / kBlocks,
                                           .mean_square = 1 + 4 * std::sqrt(2 / kBlocks)};
  const auto bsdf_mis = statistics::z_test(bsdf, mis, limits);
  EXPECT_TRUE(bsdf_mis.passed) << "BSDF samples and both: " << bsdf_mis.summary();
  const auto emitter_mis = statistics::z_test(emitter, mis, limits);
  EXPECT_TRUE(emitter_mis.passed) << "emitter samples and both: " << emitter_mis.summary();
  const auto bsdf_emitter = statistics::z_test(bsdf, emitter, limits);
  EXPECT_TRUE(bsdf_emitter.passed) << "BSDF samples and emitter samples: " << bsdf_emitter.summary();
}

TEST(VeachScene, MultipleImportanceSamplingIsTheLeastNoisy) {
  const auto variance = [](const IntegratorSettings& integrator) {
    return mean_variance(render_or_throw(veach(integrator, SamplerKind::kIndependent, 256)));
  };
  const double bsdf = variance(kBsdf), emitter = variance(kEmitter), mis = variance(kMis);
  RecordProperty("bsdf", std::to_string(bsdf));
  RecordProperty("emitter", std::to_string(emitter));
  RecordProperty("mis", std::to_string(mis));
  EXPECT_LT(mis, bsdf);
  EXPECT_LT(mis, emitter);
}

}  // namespace
}  // namespace penumbra
