// Published Cornell boxes, unedited, against images by other renderers.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <ostream>
#include <string>

#include "tests/acceptance/mitsuba_reference.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/oracles.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

struct BackendCase {
  std::string name;
  TestDevice (*device)();
  int batches;
  std::uint32_t spp;
};

void PrintTo(const BackendCase& backend, std::ostream* out) { *out << backend.name; }

class BitterliCornellBox : public testing::TestWithParam<BackendCase> {
 protected:
  void SetUp() override { PENUMBRA_NEED_ORACLE("bitterli/cornell-box"); }
};

TEST_P(BitterliCornellBox, AgreesWithTungstenAndMitsuba) {
  const auto folder = *find_oracle("bitterli/cornell-box");
  const BackendCase& backend = GetParam();
  SceneDescription scene = read_or_throw(folder / "scene.xml");
  ASSERT_EQ(scene.film.width, 1024);
  ASSERT_EQ(scene.film.height, 1024);
  scene.sampler.spp = backend.spp;
  const statistics::Estimate ours = block_estimate(scene, backend.batches, 1, 4, backend.device());

  const statistics::Image tungsten = read_rgb(folder / "TungstenRender.exr");
  const statistics::Estimate mitsuba = mitsuba_blocks(folder);
  for (int channel = 0; channel < 3; ++channel) {
    const double mean = channel_mean(ours.mean, channel);
    const double by_tungsten = channel_mean(tungsten, channel),
                 by_mitsuba = channel_mean(mitsuba.mean, channel);
    EXPECT_NEAR(mean / by_tungsten, 1, 0.002) << "channel " << channel;
    EXPECT_NEAR(mean / by_mitsuba, 1, 0.001) << "channel " << channel;
  }
  const auto result = statistics::z_test(ours, mitsuba);
  EXPECT_TRUE(result.passed) << result.summary();
  RecordProperty("z_test", result.summary());
}

INSTANTIATE_TEST_SUITE_P(Backends, BitterliCornellBox,
                         testing::Values(BackendCase{"Native", native_device, 8, 4},
                                         BackendCase{"OpenCl", opencl_device, 8, 4}),
                         [](const auto& info) { return info.param.name; });

TEST(MitsubaCornellBox, ReadsUneditedAndStrategiesAgree) {
  PENUMBRA_NEED_ORACLE("mitsuba/scenes/cbox");
  SceneDescription scene = read_or_throw(*find_oracle("mitsuba/scenes/cbox/cbox-rgb.xml"));
  EXPECT_EQ(scene.film.width, 256);
  EXPECT_EQ(param::max_depth(scene.integrator), 6);
  EXPECT_TRUE(scene.warnings.empty());
  resize_film(scene, 32, 32);
  // The depth limit binds all strategies alike: a path of six edges.
  const auto estimate = [&](DirectSampling sampling, std::uint32_t spp, std::uint32_t seed) {
    param::direct_sampling(scene.integrator) = sampling;
    scene.sampler.spp = spp;
    return block_estimate(scene, 8, seed, 4);
  };
  const statistics::Estimate mis = estimate(DirectSampling::kMis, 256, 10);
  const statistics::Estimate emitters = estimate(DirectSampling::kEmitterOnly, 256, 20);
  const statistics::Estimate chance = estimate(DirectSampling::kBsdfOnly, 1024, 30);
  // 64 blocks, whose channels go nearly together: the mean of z^2 has the deviation of that many values.
  const statistics::ImageTestLimits limits{.mean_square = 1 + 4 * std::sqrt(2.0 / 64)};
  const auto by_emitters = statistics::z_test(mis, emitters, limits);
  EXPECT_TRUE(by_emitters.passed) << by_emitters.summary();
  const auto by_chance = statistics::z_test(mis, chance, limits);
  EXPECT_TRUE(by_chance.passed) << by_chance.summary();
}

}  // namespace
}  // namespace penumbra
