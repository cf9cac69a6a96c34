// The feature mask changes no bit of the image: every scene is rendered with exactly the features that it
// needs, and with all.
#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <vector>

#include "kernels/host/kernel_needs.h"
#include "kernels/host/native_kernels.h"
#include "tests/acceptance/suite_scenes.h"
#include "tests/support/extra_families/extra_family_kernels.h"
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

/// Of results with all planes that scenes of `told` features have, those that scenes of `own` features have.
void keep_planes_of(std::vector<float>& values, std::size_t pixels, std::uint64_t own, std::uint64_t told) {
  const auto plane = [&](int number) {
    return values.begin() + std::ptrdiff_t(std::size_t(number) * pixels);
  };
  std::vector<float> kept(values.begin(), plane(kRadiancePlanes));
  for (int layer = 0; layer < FILM_LAYERS; ++layer) {
    const int first = layer_plane(told, layer);
    if (has_layer(own, layer))
      kept.insert(kept.end(), plane(first), plane(first + kFilmLayers[layer].planes));
  }
  values = std::move(kept);
}

/// By one variant, whatever the device would choose; the planes that a scene of `own` features has.
std::vector<std::uint32_t> render_with(const NativeKernel& kernel, const DeviceScene& scene,
                                       std::uint64_t own) {
  constexpr int kPaths = 1024;
  const RenderUnit unit = whole_film(scene.header);
  std::vector<float> values = render_native_blocks(kernel, scene, unit, kPaths);
  keep_planes_of(values, std::size_t(unit.width) * std::size_t(unit.height), own, scene.header.features);
  return bits_of(values);
}

/// The scene, said to need that.
DeviceScene with_needs(DeviceScene scene, const KernelNeeds& needs) {
  scene.header.features = needs.features;
  scene.header.families = needs.families;
  scene.header.light_kinds = needs.light_kinds;
  return scene;
}

/// By OpenCL kernels compiled for these needs; the planes that the scene has.
std::vector<std::uint32_t> render_with_opencl(const DeviceScene& own, const KernelNeeds& needs) {
  const DeviceScene scene = with_needs(own, needs);
  const auto device = make_device(scene, opencl_device().options);
  if (!device) throw std::runtime_error(device.error().message);
  auto result = (*device)->render(whole_film(scene.header));
  if (!result) throw std::runtime_error(result.error().message);
  keep_planes_of(result->values, result->pixels(), own.header.features, scene.header.features);
  return bits_of(result->values);
}

class FeatureMask : public testing::TestWithParam<SuiteScene> {
 protected:
  void SetUp() override {
    if (GetParam().is_oracle) PENUMBRA_NEED_ORACLE(GetParam().file);
    scene_ = build_or_throw(small_scene(GetParam()));
    own_ = needs_of(scene_.header);
    everything_ = every_need(scene_.header);
  }

  DeviceScene scene_;
  KernelNeeds own_, everything_;
};

TEST_P(FeatureMask, EveryNativeKernelGivesTheSameBytesWhateverItIsToldThatTheSceneNeeds) {
  const auto reference = render_with(extra_family_kernel(true), scene_, own_.features);
  const DeviceScene told = with_needs(scene_, everything_);
  int compared = 0;
  for (const NativeKernel& kernel : one_lane_and_native_kernels()) {
    ++compared;
    EXPECT_TRUE(render_with(kernel, scene_, own_.features) == reference)
        << isa_name(kernel.isa) << ", " << kernel.lanes << " lanes";
    EXPECT_TRUE(render_with(kernel, told, own_.features) == reference)
        << "every stage, " << isa_name(kernel.isa) << ", " << kernel.lanes << " lanes";
  }
  EXPECT_GE(compared, 2);
}

TEST_P(FeatureMask, OpenClWithTheScenesOwnNeedsAndWithAllGivesTheSameBytes) {
  ASSERT_NE(own_.features, everything_.features) << "nothing is left out, so nothing is tested";
  const auto native = render_with(extra_family_kernel(true), scene_, own_.features);
  EXPECT_TRUE(render_with_opencl(scene_, own_) == native) << "the scene's own needs";
  EXPECT_TRUE(render_with_opencl(scene_, everything_) == native) << "everything";
}

INSTANTIATE_TEST_SUITE_P(Scenes, FeatureMask, testing::ValuesIn(suite_scenes()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace penumbra
