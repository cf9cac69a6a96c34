// BSDF families that the renderer does not have: delta directions, transmission and refraction in the
// kernels; and the same bits with any number of lanes.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "tests/acceptance/extra_family_scenes.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

/// The planes of one lane and of many have the same bits.
void expect_same_bits(ExtraFamilyScene scene) {
  scene.description.sampler.spp = 8;
  const DeviceScene built = scene.build();
  const std::vector<float> one_lane = render_extra_families(extra_family_kernel(true), built);
  const std::vector<float> many = render_extra_families(extra_family_kernel(), built);
  ASSERT_EQ(many.size(), one_lane.size());
  EXPECT_EQ(std::memcmp(many.data(), one_lane.data(), many.size() * sizeof(float)), 0);
}

TEST(ExtraFamilyFamilies, GiveTheSameBitsForAnyNumberOfLanes) {
  for (const bool many_triangles : {false, true}) {
    ExtraFamilyScene room = extra_family_room({.front_pane = true, .many_triangles = many_triangles});
    EXPECT_EQ((room.build().header.features & FEATURE_BVH) != 0, many_triangles);
    expect_same_bits(room);
    param::next_event(room.description.integrator) = NextEvent::kCv;
    expect_same_bits(room);
    room.description.integrator = direct_integrator(1, 2);
    expect_same_bits(room);
    use(room.description.integrator, IntegratorKind::kWhitted);
    param::indirect_samples(room.description.integrator) = 2;
    param::max_depth(room.description.integrator) = 5;
    expect_same_bits(room);
  }
  ExtraFamilyScene glass = room_with_glass();
  use(glass.description.integrator, IntegratorKind::kWhitted);
  param::branch_depth(glass.description.integrator) = 6;
  expect_same_bits(glass);
  expect_same_bits(glass_ball(1.5f));
}

// Nothing but the surface's own direction leads through a window, and that never meets a point.
TEST(ExtraFamilyFamilies, WindowsBlockPointLights) {
  ExtraFamilyScene room = extra_family_room({.mirror = false, .light_pane = true});
  SceneDescription& scene = room.description;
  std::erase_if(scene.shapes, [](const Shape& shape) { return shape.radiance.has_value(); });
  scene.emitters = {PointLight{glm::dvec3(0, 2.4, 0), glm::vec3(1)}};
  param::max_depth(scene.integrator) = 2;  // walls above the window are lit
  EXPECT_EQ(extra_family_sample(room, 0).mean(), 0);
}

// Radiance is 16 times larger within the ball, and the throughput of paths there 16 times smaller, which says
// nothing of what they will bring: roulette from the first surface on lets 98 % of them go on, and the
// samples' variance is .02 for each surface. By throughput alone it would be sqrt(2 / 16) of them, and a
// variance of 1.9.
TEST(ExtraFamilyFamilies, RouletteKnowsThatMediaAreDense) {
  ExtraFamilyScene ball = glass_ball(4);
  param::rr_depth(ball.description.integrator) = 0;
  const statistics::Sample sample = extra_family_sample(ball, 0);
  EXPECT_GT(statistics::t_test(sample, 1, 1e-5).p, .01) << sample.mean();
  EXPECT_LT(sample.variance(), .05);
}

TEST(ExtraFamilyFamilies, GlassBallInAFurnaceIsInvisible) {
  ExtraFamilyScene ball = glass_ball(1.5f);
  param::max_depth(ball.description.integrator) = 4;  // in, out, environment
  param::rr_depth(ball.description.integrator) = 5;   // no roulette
  const statistics::Sample sample = extra_family_sample(ball, 1);
  EXPECT_NEAR(sample.mean(), 1, 1e-5);
  EXPECT_LT(sample.variance(), 1e-9);
}

// Direct light: a mirror's is found by its own directions, which count in full; where there are none, closed
// forms and samples of emitters light the others.
TEST(ExtraFamilyFamilies, DirectLightIsThatOfPathsOfTwoEdges) {
  const auto image = [](const IntegratorSettings& integrator, bool mirror, std::uint32_t seed) {
    ExtraFamilyScene room = extra_family_room({.mirror = mirror});
    room.description.integrator = integrator;
    return extra_family_estimate(room, 8, seed, 4);
  };
  IntegratorSettings paths;
  param::max_depth(paths) = 2;
  const statistics::ImageTestLimits limits{.accepted_fraction = 1, .mean_square = 2.2};
  const auto direct =
      statistics::z_test(image(paths, true, 100), image(direct_integrator(1, 1), true, 200), limits);
  EXPECT_TRUE(direct.passed) << direct.summary();
  IntegratorSettings closed_forms;
  use(closed_forms, IntegratorKind::kPolygonCv);
  param::alpha(closed_forms) = 1.0f;
  const auto cv = statistics::z_test(image(paths, false, 300), image(closed_forms, false, 400), limits);
  EXPECT_TRUE(cv.passed) << cv.summary();
}

}  // namespace
}  // namespace penumbra
