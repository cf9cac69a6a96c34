// Closed forms are a property of the surface. Surfaces without one (mirrors, some glossy families, windows)
// sample lights as usual beside surfaces whose light has a control variate, and no light is lost or counted
// twice. Uses families that only tests have. Mean z^2 is about 1 here. It becomes about 30 beside mirrors, 10
// to 25 behind a window and 70 under one if any of these is wrong: rays that leave surfaces without a closed
// form drop the lights they find, every surface is treated as one with a closed form, or sampling of emitters
// alone forgets what mirrors show. It becomes 4 to 9 if light of surfaces with a closed form is counted by
// both strategies.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "tests/acceptance/extra_family_scenes.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra {
namespace {

constexpr int kBlock = 4, kBatches = 8;
constexpr double kBlocks = (24 / kBlock) * (16 / kBlock);

struct Method {
  std::string name;
  IntegratorSettings integrator;
};

void PrintTo(const Method& method, std::ostream* out) { *out << method.name; }

Method sampled(const std::string& name, DirectSampling sampling) {
  IntegratorSettings settings;
  param::direct_sampling(settings) = sampling;
  return {name, settings};
}

Method controlled(const std::string& name, std::optional<float> alpha) {
  IntegratorSettings settings;
  param::next_event(settings) = NextEvent::kCv;
  param::alpha(settings) = alpha;
  return {name, settings};
}

std::vector<Method> controlled_methods() {
  return {controlled("AlphaOne", 1.0f), controlled("AlphaAuto", std::nullopt)};
}

std::vector<Method> all_methods() {
  std::vector<Method> methods{sampled("Mis", DirectSampling::kMis),
                              sampled("EmitterOnly", DirectSampling::kEmitterOnly),
                              sampled("BsdfOnly", DirectSampling::kBsdfOnly)};
  for (const Method& method : controlled_methods()) methods.push_back(method);
  return methods;
}

/// A z-test for each block of pixels, at a chance of 1 % of failing though both have one mean, for fixed
/// seeds. The channels of a block go together: the mean of z^2 has the deviation of as many values as there
/// are blocks.
void expect_same_mean(const ExtraFamilyScene& a, const ExtraFamilyScene& b) {
  const statistics::ImageTestLimits limits{.accepted_fraction = 1,
                                           .mean_square = 1 + 4 * std::sqrt(2 / kBlocks)};
  const auto result = statistics::z_test(extra_family_estimate(a, kBatches, 100, kBlock),
                                         extra_family_estimate(b, kBatches, 200, kBlock), limits);
  EXPECT_TRUE(result.passed) << result.summary();
}

ExtraFamilyScene room_by(const Method& method, const RoomOptions& options = {}) {
  ExtraFamilyScene room = extra_family_room(options);
  room.description.integrator = method.integrator;
  return room;
}

class ClosedFormSurfaces : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Methods, ClosedFormSurfaces, testing::ValuesIn(all_methods()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(ClosedFormSurfaces, HaveTheMeanOfPathsBesideMirrors) {
  expect_same_mean(extra_family_room(), room_by(GetParam()));
}

// Also in the hierarchy.
TEST_P(ClosedFormSurfaces, AreSeenThroughAWindow) {
  expect_same_mean(extra_family_room({.mirror = false}),
                   room_by(GetParam(), {.mirror = false, .front_pane = true, .many_triangles = true}));
}

// A window blocks shadow rays: light behind it is found by directions that BSDFs sample alone. The window
// scatters into one direction, which no light is sampled in, so what they find counts in full.
TEST_P(ClosedFormSurfaces, AreLitThroughAWindow) {
  expect_same_mean(extra_family_room({.mirror = false}),
                   room_by(GetParam(), {.mirror = false, .light_pane = true}));
}

}  // namespace
}  // namespace penumbra
