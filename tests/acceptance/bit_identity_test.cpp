// Bit identity: one scene gives the same bytes with every instruction set, with blocks of one path, and with
// OpenCL, using the portable intersector. film_hash_test.cpp tests more scenes and compilers,
// feature_mask_test.cpp the feature mask, and embree_difference_test.cpp Embree.
#include <gtest/gtest.h>

#include <string>

#include "tests/acceptance/suite_scenes.h"
#include "tests/support/oracles.h"

namespace penumbra {
namespace {

class BitIdentity : public testing::TestWithParam<SuiteScene> {
 protected:
  void SetUp() override {
    if (GetParam().is_oracle) PENUMBRA_NEED_ORACLE(GetParam().file);
  }
};

TEST_P(BitIdentity, EveryBackendGivesTheSameBytes) {
  const DeviceScene scene = build_or_throw(small_scene(GetParam()));
  TestDevice device = native_device();
  device.options.threads = 1;
  device.options.block_of_one = true;
  const FilmAccumulator reference = render_or_throw(scene, device);
  ASSERT_GT(reference.at(20, 15).count, 0u);
  const auto expect_same = [&](const TestDevice& other, const std::string& name) {
    const FilmAccumulator film = render_or_throw(scene, other);
    EXPECT_EQ(film.hash(), reference.hash()) << name << " differs " << first_difference(reference, film);
  };
  device.options.block_of_one = false;
  for (const Isa isa : usable_isas()) {
    device.options.isa = isa;
    for (const int threads : {1, 2}) {
      device.options.threads = threads;
      expect_same(device, std::string(isa_name(isa)) + " with " + std::to_string(threads) + " threads");
    }
  }
  expect_same(opencl_device(), "OpenCL");
}

INSTANTIATE_TEST_SUITE_P(Scenes, BitIdentity, testing::ValuesIn(suite_scenes()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace penumbra
