// The whitted integrator: its mean is that of the path integrator, without the latter's noise at mirrors and
// glass.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "tests/acceptance/extra_family_scenes.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

struct WhittedCase {
  std::string name;
  int max_depth;
  int branch_depth;
  int indirect_samples;
  IndirectSampling indirect_sampling = IndirectSampling::kCosine;
  NextEvent next_event = NextEvent::kSample;
  MisHeuristic heuristic = MisHeuristic::kBalance;
  bool looks_through = false;
};
void PrintTo(const WhittedCase& c, std::ostream* out) { *out << c.name; }

const WhittedCase kCases[] = {
    {"OneEdge", 1, 4, 1},
    {"DirectLight", 2, 4, 1},
    {"ThreeEdges", 3, 4, 2},
    {"SixEdges", 6, 8, 1},
    {"SixEdgesUniform", 6, 2, 1, IndirectSampling::kUniform},
    {"SixEdgesByBsdf", 6, 2, 3, IndirectSampling::kBsdf},
    {"NoBranches", 5, 0, 1},
    {"ManyDirections", 4, 2, 3},
    {"NoLimit", -1, 3, 2},
    {"PowerHeuristic", 4, 3, 2, IndirectSampling::kCosine, NextEvent::kSample, MisHeuristic::kPower},
    {"ControlVariate", 4, 3, 2, IndirectSampling::kCosine, NextEvent::kCv},
    {"ControlVariateUniform", 3, 1, 3, IndirectSampling::kUniform, NextEvent::kCv},
    {"LooksThrough", 4, 3, 2, IndirectSampling::kCosine, NextEvent::kSample, MisHeuristic::kBalance, true},
};

class Whitted : public testing::TestWithParam<WhittedCase> {
 protected:
  /// Both integrators' images of the scene are equal.
  static void expect_light_of_path(ExtraFamilyScene scene) {
    const WhittedCase& c = GetParam();
    scene.description.sampler.spp = 128;
    IntegratorSettings& integrator = scene.description.integrator;
    if (c.looks_through) {
      integrator.hide_emitters = true;
      integrator.hidden_emitters = HiddenEmitters::kLookedThrough;
    }
    param::max_depth(integrator) = c.max_depth;
    const statistics::Estimate by_path = extra_family_estimate(scene, 8, 1000, 4);
    use(integrator, IntegratorKind::kWhitted);
    param::branch_depth(integrator) = c.branch_depth;
    param::indirect_samples(integrator) = c.indirect_samples;
    param::indirect_sampling(integrator) = c.indirect_sampling;
    param::next_event(integrator) = c.next_event;
    param::heuristic(integrator) = c.heuristic;
    if (c.next_event == NextEvent::kCv) param::alpha(integrator) = 0.8f;
    const auto result = statistics::z_test(by_path, extra_family_estimate(scene, 8, 2000, 4),
                                           {.accepted_fraction = 1, .mean_square = 2.2});
    EXPECT_TRUE(result.passed) << result.summary();
  }
};
INSTANTIATE_TEST_SUITE_P(Cases, Whitted, testing::ValuesIn(kCases),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(Whitted, IsPathInARoomWithAMirrorAndAWindow) {
  expect_light_of_path(extra_family_room({.front_pane = true, .light_pane = GetParam().name == "SixEdges"}));
}

TEST_P(Whitted, IsPathInARoomWithAGlassBall) { expect_light_of_path(room_with_glass()); }

/// A ball of glass of index 4, seen along its axis, in an environment of radiance 1.
ExtraFamilyScene ball_of_glass() {
  ExtraFamilyScene ball = glass_ball(4);
  ball.extra_families.clear();
  Shape& sphere = ball.description.shapes.at(0);
  std::tie(sphere.front_bsdf, sphere.back_bsdf) = add_glass(ball.description, 4);
  SceneDescription& scene = ball.description;
  scene.camera = look_at({0, 0, -4}, {0, 0, 0}, {0, 1, 0}, 0.01);
  scene.sampler.spp = 64;
  use(scene.integrator, IntegratorKind::kWhitted);
  return ball;
}

// Of the light along paths of up to D edges all but (1 - R) R^(D - 2) arrives: what is still inside. R = .36
// is the reflectance at each of its surfaces. Both branches are followed at all D - 1 of them.
TEST(Whitted, FollowsBothBranchesWithTheirExactWeights) {
  for (const int edges : {2, 3, 4, 5, 8}) {
    ExtraFamilyScene ball = ball_of_glass();
    param::max_depth(ball.description.integrator) = edges;
    param::rr_depth(ball.description.integrator) = 100;
    param::branch_depth(ball.description.integrator) = edges - 1;
    const statistics::Sample sample = extra_family_sample(ball, 1);
    const double expected = 1 - 0.64 * std::pow(0.36, edges - 2);
    EXPECT_NEAR(sample.mean(), expected, 1e-5) << edges;
    EXPECT_LT(sample.variance(), 1e-10) << edges;
    use(ball.description.integrator, IntegratorKind::kPath);
    const statistics::Sample by_path = extra_family_sample(ball, 1);
    EXPECT_GT(statistics::t_test(by_path, expected, 1e-5).p, .01) << edges;
    EXPECT_GT(by_path.variance(), 1e-3) << "path chooses";
  }
}

// Beyond branch_depth it chooses as path does, and roulette takes branches: the mean stays.
TEST(Whitted, ChoosesBeyondItsBranches) {
  for (const int branches : {0, 1, 3}) {
    for (const int rr_depth : {1, 100}) {
      ExtraFamilyScene ball = ball_of_glass();
      param::max_depth(ball.description.integrator) = 6;
      param::rr_depth(ball.description.integrator) = rr_depth;
      param::branch_depth(ball.description.integrator) = branches;
      const statistics::Sample sample = extra_family_sample(ball, 0);
      EXPECT_GT(statistics::t_test(sample, 1 - 0.64 * std::pow(0.36, 4), 1e-5).p, .01)
          << branches << " " << rr_depth;
      EXPECT_GT(sample.variance(), 1e-6);
    }
  }
}

/// A closed room with a ball of glass, a bubble, a mirror and a light.
SceneDescription room_of_the_renderers_own() {
  SceneDescription scene = empty_scene(24, 16, 128, 0);
  scene.sampler.kind = SamplerKind::kSobol;
  scene.camera = look_at({0, 1, -3.5}, {0, 1, 2}, {0, 1, 0}, 60);
  const auto add = [&](const BsdfModel& model) {
    scene.bsdfs.push_back({"", model});
    return int(scene.bsdfs.size()) - 1;
  };
  const auto add_ball = [&](glm::dvec3 center, double radius, int front, int back) {
    Shape ball;
    ball.name = "ball";
    ball.geometry = Sphere{.center = center, .radius = radius};
    ball.front_bsdf = front;
    ball.back_bsdf = back;
    scene.shapes.push_back(ball);
  };
  const int white = add_diffuse(scene, 0.7f);
  const DielectricBsdf glass;
  const int outside = add(glass), inside = add(glass.other_side()), pane = add(ThinDielectricBsdf{});
  add_ball({0, 0, 0}, 5, kBlackBsdf, white);
  add_ball({-0.7, 0.8, 0.5}, 0.8, outside, inside);
  add_ball({0.9, 1.6, 0.2}, 0.6, pane, pane);
  add_ball({0.8, 0.3, 0.8}, 0.5, add(ConductorBsdf{}), kBlackBsdf);
  scene.shapes.push_back(parallelogram({-3, -0.5, -3}, {0, 0, 6}, {6, 0, 0}, add(PlasticBsdf{})));
  scene.shapes.push_back(parallelogram({-1, 3, -1}, {2, 0, 0}, {0, 0, 2}, kBlackBsdf, 4.0f));
  return scene;
}

TEST(Whitted, IsPathInARoomOfTheRenderersOwnMirrorsAndGlass) {
  SceneDescription room = room_of_the_renderers_own();
  room.integrator = path_integrator(DirectSampling::kMis);
  param::max_depth(room.integrator) = 7;
  const statistics::Estimate by_path = block_estimate(room, 8, 100, 4);
  use(room.integrator, IntegratorKind::kWhitted);
  param::branch_depth(room.integrator) = 5;
  for (const TestDevice& device : {native_device(), opencl_device()}) {
    const auto result = statistics::z_test(by_path, block_estimate(room, 8, 200, 4, device),
                                           {.accepted_fraction = 1, .mean_square = 2.2});
    EXPECT_TRUE(result.passed) << result.summary();
  }
  // Plastic has a control lobe.
  param::next_event(room.integrator) = NextEvent::kCv;
  param::alpha(room.integrator) = 0.8f;
  const auto cv = statistics::z_test(by_path, block_estimate(room, 8, 300, 4),
                                     {.accepted_fraction = 1, .mean_square = 2.2});
  EXPECT_TRUE(cv.passed) << cv.summary();
}

// Light that is reflected by a diffuse surface and found by no mirror.
TEST(Whitted, WithoutDirectionsDiffuseSurfacesHaveDirectLightAlone) {
  ExtraFamilyScene room = extra_family_room({.mirror = false});
  room.description.sampler.spp = 128;
  param::max_depth(room.description.integrator) = 2;
  const statistics::Estimate direct = extra_family_estimate(room, 8, 100, 4);
  param::max_depth(room.description.integrator) = 7;
  use(room.description.integrator, IntegratorKind::kWhitted);
  param::indirect_samples(room.description.integrator) = 0;
  const auto result = statistics::z_test(direct, extra_family_estimate(room, 8, 200, 4),
                                         {.accepted_fraction = 1, .mean_square = 2.2});
  EXPECT_TRUE(result.passed) << result.summary();
}

TEST(Whitted, SeveralDirectionsHaveLessNoise) {
  ExtraFamilyScene room = extra_family_room({.mirror = false});
  use(room.description.integrator, IntegratorKind::kWhitted);
  param::max_depth(room.description.integrator) = 3;
  const double one = extra_family_sample(room, 1).variance();
  param::indirect_samples(room.description.integrator) = 8;
  EXPECT_LT(extra_family_sample(room, 1).variance(), one);
}

}  // namespace
}  // namespace penumbra
