// Control variates that differ from the closure's own value: however different their lobes are, the mean is
// that of paths, and it does not depend on lanes and acceleration structures.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "tests/acceptance/extra_family_scenes.h"
#include "tests/acceptance/scene_pieces.h"
#include "tests/acceptance/shadowed_polygon.h"
#include "tests/support/integrator_parameters.h"

namespace penumbra::nearly_closed_form_test {
namespace {

constexpr int kBlock = 4;
constexpr double kBlocks = 24.0 / kBlock * 16 / kBlock;
// The channels of a block go together: the mean of z^2 has the deviation of as many values as there are
// blocks.
const statistics::ImageTestLimits kLimits{.accepted_fraction = 1,
                                          .mean_square = 1 + 4 * std::sqrt(2 / kBlocks)};

struct Variant {
  std::string name;
  std::optional<float> alpha;
  EmitterSampling sampling = EmitterSampling::kSolidAngle;
};
void PrintTo(const Variant& variant, std::ostream* out) { *out << variant.name; }

void use_variant(IntegratorSettings& integrator, const Variant& variant) {
  param::alpha(integrator) = variant.alpha;
  param::emitter_sampling(integrator) = variant.sampling;
}

class NearlyClosedForm : public testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(Variants, NearlyClosedForm,
                         testing::Values(Variant{"MinusOne", -1.0f}, Variant{"Zero", 0.0f},
                                         Variant{"Half", 0.5f}, Variant{"One", 1.0f},
                                         Variant{"Fitted", std::nullopt},
                                         Variant{"OneByArea", 1.0f, EmitterSampling::kArea},
                                         Variant{"OneByProjection", 1.0f, EmitterSampling::kProjected}),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(NearlyClosedForm, PathsHaveTheMeanOfPaths) {
  ExtraFamilyScene room = extra_family_room({.crude = true});
  param::max_depth(room.description.integrator) = 4;
  const statistics::Estimate paths = extra_family_estimate(room, 8, 100, kBlock);
  param::next_event(room.description.integrator) = NextEvent::kCv;
  use_variant(room.description.integrator, GetParam());
  EXPECT_NE(room.build().header.features & FEATURE_LTC, 0u);
  const auto result = statistics::z_test(paths, extra_family_estimate(room, 8, 200, kBlock), kLimits);
  EXPECT_TRUE(result.passed) << result.summary();
}

TEST_P(NearlyClosedForm, DirectLightHasTheMeanOfDirectLight) {
  ExtraFamilyScene room = extra_family_room({.mirror = false, .crude = true});
  room.description.integrator = direct_integrator(1, 1);
  const statistics::Estimate direct = extra_family_estimate(room, 8, 300, kBlock);
  use(room.description.integrator, IntegratorKind::kPolygonCv);
  use_variant(room.description.integrator, GetParam());
  const auto result = statistics::z_test(direct, extra_family_estimate(room, 8, 400, kBlock), kLimits);
  EXPECT_TRUE(result.passed) << result.summary();
}

// Points on lights by the lobes' own distributions, alone and balanced with the closures' directions.
TEST(NearlyClosedFormSamples, HaveTheMeanOfPaths) {
  ExtraFamilyScene room = extra_family_room({.crude = true});
  param::max_depth(room.description.integrator) = 4;
  const statistics::Estimate paths = extra_family_estimate(room, 8, 500, kBlock);
  EXPECT_EQ(room.build().header.features & FEATURE_LTC, 0u);
  param::emitter_sampling(room.description.integrator) = EmitterSampling::kProjected;
  EXPECT_NE(room.build().header.features & FEATURE_LTC, 0u);
  const auto balanced = statistics::z_test(paths, extra_family_estimate(room, 8, 600, kBlock), kLimits);
  EXPECT_TRUE(balanced.passed) << balanced.summary();

  ExtraFamilyScene direct = extra_family_room({.mirror = false, .crude = true});
  direct.description.integrator = direct_integrator(1, 1);
  const statistics::Estimate both = extra_family_estimate(direct, 32, 700, kBlock);
  param::emitter_sampling(direct.description.integrator) = EmitterSampling::kProjected;
  const auto mis = statistics::z_test(both, extra_family_estimate(direct, 8, 800, kBlock), kLimits);
  EXPECT_TRUE(mis.passed) << mis.summary();
  for (const LightChoice choice : {LightChoice::kPower, LightChoice::kAnalytic}) {
    direct.description.integrator = emitter_only(EmitterSampling::kProjected, 1, choice);
    const auto alone = statistics::z_test(both, extra_family_estimate(direct, 32, 900, kBlock), kLimits);
    EXPECT_TRUE(alone.passed) << alone.summary();
  }
}

// A wrong G would show: its lobes are far from the closure.
TEST(NearlyClosedFormImages, TheClosedFormAloneIsAnother) {
  ExtraFamilyScene room = extra_family_room({.mirror = false, .crude = true});
  room.description.integrator = direct_integrator(1, 1);
  const statistics::Estimate direct = extra_family_estimate(room, 8, 300, kBlock);
  use(room.description.integrator, IntegratorKind::kPolygonAnalytic);
  EXPECT_FALSE(statistics::z_test(direct, extra_family_estimate(room, 2, 400, kBlock), kLimits).passed);
}

TEST(NearlyClosedFormImages, DoNotDependOnLanes) {
  for (const bool many_triangles : {false, true}) {
    ExtraFamilyScene room = extra_family_room({.many_triangles = many_triangles, .crude = true});
    param::next_event(room.description.integrator) = NextEvent::kCv;
    room.description.sampler.spp = 8;
    const DeviceScene built = room.build();
    const std::vector<float> one_lane = render_extra_families(extra_family_kernel(true), built);
    const std::vector<float> many = render_extra_families(extra_family_kernel(), built);
    ASSERT_EQ(many.size(), one_lane.size());
    EXPECT_EQ(std::memcmp(many.data(), one_lane.data(), many.size() * sizeof(float)), 0);
  }
}

}  // namespace
}  // namespace penumbra::nearly_closed_form_test
