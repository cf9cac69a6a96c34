// Whole rooms of other people's, read as they are, against Mitsuba 3.
#include <gtest/gtest.h>

#include "tests/acceptance/mitsuba_reference.h"
#include "tests/support/oracles.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

TEST(BitterliSpaceship, AgreesWithMitsuba) {
  PENUMBRA_NEED_ORACLE("bitterli/spaceship");
  const auto folder = *find_oracle("bitterli/spaceship");
  SceneDescription scene = read_or_throw(folder / "scene.xml");
  ASSERT_EQ(scene.film.width, 1280);
  ASSERT_EQ(scene.film.height, 720);
  scene.sampler.spp = 8;
  const statistics::Estimate ours = block_estimate(scene, 8, 1, 4), mitsuba = mitsuba_blocks(folder);
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(channel_mean(ours.mean, channel) / channel_mean(mitsuba.mean, channel), 1, 0.003)
        << "channel " << channel;
  const auto result = statistics::z_test(ours, mitsuba);
  EXPECT_TRUE(result.passed) << result.summary();
  RecordProperty("z_test", result.summary());
}

}  // namespace
}  // namespace penumbra
