// Embree against the portable intersector: which pixels differ, and that each difference has a reason that is
// no error of either. Prints a line for each scene:
//    build/release/bit_identity_test --gtest_filter='*Embree*'
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/acceptance/embree_differences.h"
#include "tests/acceptance/suite_scenes.h"
#include "tests/support/oracles.h"

namespace penumbra {
namespace {

class Embree : public testing::TestWithParam<SuiteScene> {
 protected:
  void SetUp() override {
    if (GetParam().is_oracle) PENUMBRA_NEED_ORACLE(GetParam().file);
  }
};

bool same_pixel(const PixelStatistics& a, const PixelStatistics& b) {
  return std::ranges::equal(a.mean, b.mean) && std::ranges::equal(a.m2, b.m2) && a.count == b.count;
}

TEST_P(Embree, DiffersOnlyInPixelsWhoseRaysAreInDoubt) {
  SceneDescription description = small_scene(GetParam());
  description.sampler.spp = 16;
  const FilmAccumulator portable = render_or_throw(build_or_throw(description));
  const DeviceScene scene = build_or_throw(description, true);
  ASSERT_EQ(scene.header.intersector, INTERSECTOR_EMBREE);
  const double pixels = double(portable.width()) * portable.height();
  for (const Isa isa : usable_isas()) {
    TestDevice device = native_device();
    device.options.isa = isa;
    const FilmAccumulator embree = render_or_throw(scene, device);
    const EmbreeDifferences differences = find_embree_differences(scene, isa);
    int differing = 0;
    for (int y = 0; y < portable.height(); ++y)
      for (int x = 0; x < portable.width(); ++x) {
        if (same_pixel(portable.at(x, y), embree.at(x, y))) continue;
        ++differing;
        EXPECT_TRUE(differences.pixels.contains({x, y}))
            << "pixel " << x << ", " << y << " differs, but all of its rays find the same";
      }
    std::string causes;
    for (int c = 0; c < kDifferenceCauses; ++c)
      if (differences.by_cause[std::size_t(c)] > 0)
        causes += fmt::format(" {} {}", cause_name(DifferenceCause(c)), differences.by_cause[std::size_t(c)]);
    const double share = differing / pixels, bound = double(differences.pixels.size()) / pixels;
    fmt::print("{:<32} {:<7} {:5.2f}% of pixels differ, bound {:5.2f}%; {} of {} rays:{}\n", GetParam().name,
               isa_name(isa), 100 * share, 100 * bound, differences.total(), differences.rays, causes);
    RecordProperty(fmt::format("differing_share_{}", isa_name(isa)), fmt::format("{:.6f}", share));
    RecordProperty(fmt::format("bound_{}", isa_name(isa)), fmt::format("{:.6f}", bound));
    RecordProperty(fmt::format("causes_{}", isa_name(isa)), causes);
    EXPECT_LE(share, bound);
    EXPECT_EQ(differences.by_cause[std::size_t(DifferenceCause::kUnexplained)], 0u);
    for (const std::string& example : differences.examples) {
      if (isa == usable_isas().front() || example.starts_with("unexplained")) fmt::print("  {}\n", example);
    }
  }
}

TEST_P(Embree, GivesTheSameBytesFromAnyThreadsOfOneInstructionSet) {
  const DeviceScene scene = build_or_throw(small_scene(GetParam()), true);
  for (const Isa isa : usable_isas()) {
    TestDevice device = native_device();
    device.options.isa = isa;
    device.options.threads = 1;
    const FilmAccumulator reference = render_or_throw(scene, device);
    device.options.threads = 3;
    EXPECT_EQ(render_or_throw(scene, device).hash(), reference.hash()) << isa_name(isa);
  }
}

class EmbreeSeeds : public Embree {};

TEST_P(EmbreeSeeds, GiveTheSameImage) {
  SceneDescription description = small_scene(GetParam());
  description.sampler.spp = 64;
  TestDevice embree = native_device();
  embree.embree = true;
  constexpr int kBatches = 6, kBlock = 10;
  const statistics::Estimate by_us = block_estimate(description, kBatches, 1, kBlock);
  const statistics::Estimate by_embree = block_estimate(description, kBatches, 1000, kBlock, embree);
  // Twelve blocks, whose channels go together: none outside, and the mean of z^2 of twelve independent
  // values. What rounds to the same everywhere has an error of the rounding alone.
  statistics::ImageTestLimits limits{.accepted_fraction = 1, .mean_square = 1 + 4 * std::sqrt(2.0 / 12)};
  statistics::Estimate ours = by_us;
  for (std::size_t i = 0; i < ours.mean.values.size(); ++i) {
    ours.standard_error.values[i] =
        std::hypot(ours.standard_error.values[i], ours.mean.values[i] * 32.0 / (1 << 24));
  }
  const auto result = statistics::z_test(ours, by_embree, limits);
  EXPECT_TRUE(result.passed) << result.summary();
}

/// Where everything is a tie, two intersectors may well show two images.
std::vector<SuiteScene> scenes_without_ties() {
  std::vector<SuiteScene> scenes = suite_scenes();
  std::erase_if(scenes, [](const SuiteScene& scene) { return scene.has_ties; });
  return scenes;
}

INSTANTIATE_TEST_SUITE_P(Scenes, EmbreeSeeds, testing::ValuesIn(scenes_without_ties()),
                         [](const auto& tested) { return tested.param.name; });
INSTANTIATE_TEST_SUITE_P(Scenes, Embree, testing::ValuesIn(suite_scenes()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace penumbra
