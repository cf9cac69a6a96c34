// What the feature mask leaves out changes no bit of the image: every scene with the kernels that have
// exactly what it needs, with all precompiled sets that cover it, and with everything.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "kernels/host/kernel_needs.h"
#include "kernels/host/native_kernels.h"
#include "tests/acceptance/suite_scenes.h"
#include "tests/support/native_blocks.h"
#include "tests/support/oracles.h"

namespace penumbra {
namespace {

/// All pixels of the film in one unit.
RenderUnit whole_film(const SceneHeader& h) {
  return {.width = h.film.width, .height = h.film.height, .first_sample = 0, .sample_count = h.sampler.spp};
}

/// To the bit: a comparison of floats would take -0 for 0.
std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits(values.size());
  std::memcpy(bits.data(), values.data(), values.size() * sizeof(float));
  return bits;
}

/// By one variant, whatever the device would choose.
std::vector<std::uint32_t> render_with(const NativeKernel& kernel, const DeviceScene& scene) {
  constexpr int kPaths = 1024;
  return bits_of(render_native_blocks(kernel, scene, whole_film(scene.header), kPaths));
}

/// By OpenCL kernels compiled for these needs; the planes that the scene has.
std::vector<std::uint32_t> render_with_opencl(DeviceScene scene, const KernelNeeds& needs) {
  const auto planes = std::size_t(plane_count(scene.header.features));
  scene.header.features = needs.features;
  scene.header.families = needs.families;
  scene.header.light_kinds = needs.light_kinds;
  const auto device = make_device(scene, opencl_device().options);
  if (!device) throw std::runtime_error(device.error().message);
  auto result = (*device)->render(whole_film(scene.header));
  if (!result) throw std::runtime_error(result.error().message);
  result->values.resize(planes * result->pixels());
  return bits_of(result->values);
}

class FeatureMask : public testing::TestWithParam<SuiteScene> {
 protected:
  void SetUp() override {
    if (GetParam().is_oracle) PENUMBRA_NEED_ORACLE(GetParam().file);
    scene_ = build_or_throw(small_scene(GetParam()));
    own_ = scene_.header.features;
    // Testing every primitive and the hierarchy exclude each other.
    everything_ = (FEATURE_ALL & ~FEATURE_BVH) | (own_ & FEATURE_BVH);
  }

  DeviceScene scene_;
  std::uint32_t own_ = 0, everything_ = 0;
};

TEST_P(FeatureMask, EveryNativeSetThatCoversTheSceneGivesTheSameBytes) {
  const NativeKernel* smallest = find_native_kernel(KernelTarget::kSse2, own_);
  ASSERT_NE(smallest, nullptr);
  const auto reference = render_with(*smallest, scene_);
  int compared = 0, with_everything = 0;
  for (const NativeKernel& kernel : native_kernels()) {
    const bool covers = (own_ & ~kernel.features) == 0 && ((own_ ^ kernel.features) & FEATURE_BVH) == 0;
    if (!covers || !machine_has(kernel.target) || &kernel == smallest) continue;
    ++compared;
    with_everything += kernel.features == everything_ ? 1 : 0;
    EXPECT_TRUE(render_with(kernel, scene_) == reference)
        << "kernels '" << kernel.features_name << "' for instruction set " << int(kernel.target);
  }
  EXPECT_GE(with_everything, 1);
  RecordProperty("smallest", std::string(smallest->features_name));
  RecordProperty("compared", compared);
}

TEST_P(FeatureMask, OpenClWithTheScenesOwnFeaturesAndWithAllGivesTheSameBytes) {
  ASSERT_NE(own_, everything_) << "nothing is left out, so nothing is tested";
  const auto native = render_with(*find_native_kernel(KernelTarget::kSse2, own_), scene_);
  EXPECT_TRUE(render_with_opencl(scene_, needs_of(scene_.header)) == native) << "the scene's own features";
  EXPECT_TRUE(render_with_opencl(scene_, {.features = everything_}) == native) << "everything";
}

INSTANTIATE_TEST_SUITE_P(Scenes, FeatureMask, testing::ValuesIn(suite_scenes()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace penumbra
