// Paths whose next-event estimation uses the closed form of polygon lights as control variate, against paths
// with MIS.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "tests/acceptance/scene_pieces.h"
#include "tests/support/integrator_parameters.h"
#include "tests/support/render_scene.h"

namespace penumbra {
namespace {

constexpr int kWidth = 24, kHeight = 16, kBlock = 4;
constexpr double kBlocks = double(kWidth / kBlock) * (kHeight / kBlock);

/// Diffuse and glossy surfaces, several bounces, a concave light and a second one; with `other_light` also a
/// point light, which has no closed form.
SceneDescription star_light(bool other_light) {
  SceneDescription scene = read_or_throw(project_file("scenes/star-light/star-light.xml"));
  resize_film(scene, kWidth, kHeight);
  if (other_light) scene.emitters.emplace_back(PointLight{glm::dvec3(-2, 3, 4), glm::vec3(6, 5, 4)});
  scene.integrator = {};
  use(scene.integrator, IntegratorKind::kPath);
  param::max_depth(scene.integrator) = 4;
  scene.sampler.kind = SamplerKind::kSobol;
  scene.sampler.spp = 256;
  return scene;
}

struct Variant {
  std::string name;
  std::optional<float> alpha;
  EmitterSampling sampling = EmitterSampling::kAuto;
  bool other_light = false;
};

void PrintTo(const Variant& variant, std::ostream* out) { *out << variant.name; }

class PathControlVariate : public testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(
    Variants, PathControlVariate,
    testing::Values(Variant{"Fitted", std::nullopt}, Variant{"One", 1.0f}, Variant{"Negative", -0.5f},
                    Variant{"OneByProjection", 1.0f, EmitterSampling::kProjected},
                    Variant{"HalfByArea", 0.5f, EmitterSampling::kArea},
                    Variant{"FittedBesideAPointLight", std::nullopt, EmitterSampling::kAuto, true}),
    [](const auto& tested) { return tested.param.name; });

TEST_P(PathControlVariate, HasTheMeanOfPaths) {
  SceneDescription scene = star_light(GetParam().other_light);
  const statistics::Estimate paths = block_estimate(scene, 8, 100, kBlock);
  param::next_event(scene.integrator) = NextEvent::kCv;
  param::alpha(scene.integrator) = GetParam().alpha;
  param::emitter_sampling(scene.integrator) = GetParam().sampling;
  const statistics::Estimate controlled = block_estimate(scene, 8, 200, kBlock);
  // The channels of a block go together: the mean of z^2 has the deviation of as many values as there are
  // blocks.
  const statistics::ImageTestLimits limits{.accepted_fraction = 1,
                                           .mean_square = 1 + 4 * std::sqrt(2 / kBlocks)};
  const auto result = statistics::z_test(paths, controlled, limits);
  EXPECT_TRUE(result.passed) << result.summary();
}

}  // namespace
}  // namespace penumbra
