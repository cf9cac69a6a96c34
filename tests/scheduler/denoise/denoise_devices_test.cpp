#include "scheduler/denoise/denoise_device.h"

#include <gtest/gtest.h>

#include "kernels/host/native_kernels.h"
#include "tests/scheduler/denoise/noisy_images.h"

namespace penumbra {
namespace {

float pattern(int x, int y, int c) { return float((x / 4 * 31 + y / 6 * 17 + c * 5) % 23) / 11; }

DenoiseInput input_of(int width, int height) {
  DenoiseInput input = noisy_image(width, height, pattern, 0.2f, 1);
  const DenoiseInput features = noisy_image(width, height, pattern, 0.05f, 2);
  for (int c = 0; c < 3; ++c) {
    std::ranges::copy(features.color.plane(c), input.features.plane(c).begin());
    std::ranges::copy(features.half_a.plane(c), input.features.plane(3 + c).begin());
  }
  std::ranges::copy(features.half_b.plane(0), input.features.plane(6).begin());
  input.valid.values[input.valid.values.size() / 3] = input.valid.values.size() > 9 ? 0 : 1;
  return input;
}

struct Size {
  int width, height;
};

class DenoiseDevices : public ::testing::TestWithParam<Size> {
 protected:
  void expect_same(DenoiseDevice& device) {
    const DenoiseInput input = input_of(GetParam().width, GetParam().height);
    const auto expected = test_device();
    const auto nfor_a = nfor(*expected, input), nfor_b = nfor(device, input);
    ASSERT_TRUE(nfor_a && nfor_b);
    EXPECT_EQ(nfor_a->color.values, nfor_b->color.values);
    EXPECT_EQ(nfor_a->residual_variance.values, nfor_b->residual_variance.values);
    const auto nlm_a = nl_means(*expected, input, {}), nlm_b = nl_means(device, input, {});
    ASSERT_TRUE(nlm_a && nlm_b);
    EXPECT_EQ(nlm_a->color.values, nlm_b->color.values);
  }
};

TEST_P(DenoiseDevices, InstructionSetsAndThreadsGiveTheSameBits) {
  for (const NativeKernel& kernel : native_kernels())
    if (machine_has(kernel.isa))
      for (const int threads : {1, 3}) expect_same(*native_denoise_device(kernel.isa, threads));
}

TEST_P(DenoiseDevices, OpenClGivesTheSameBits) {
  const auto info = find_opencl_device("");
  if (!info) GTEST_SKIP() << info.error().message;
  if (!info->is_exact) GTEST_SKIP() << info->name << " rounds in its own way";
  const auto device = opencl_denoise_device(*info, 2);
  ASSERT_TRUE(device) << device.error().message;
  expect_same(**device);
}

INSTANTIATE_TEST_SUITE_P(Sizes, DenoiseDevices,
                         ::testing::Values(Size{1, 1}, Size{3, 5}, Size{65, 33}, Size{70, 100}));

}  // namespace
}  // namespace penumbra
