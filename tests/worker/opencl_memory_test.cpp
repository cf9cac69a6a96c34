// Buffers fit into an OpenCL device's memory, and launch sizes adapt to measured launch times.
#include "worker/opencl_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace penumbra {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kPlenty = std::uint64_t(1) << 40;

OpenClDemand demand_of(int width, int height, int samples, int items = 4) {
  return {.scene_bytes = 1000,
          .path_words = 46,
          .slot_words = 11,
          .planes = 13,
          .bad_bytes = 24,
          .width = width,
          .height = height,
          .samples = samples,
          .items = items};
}

TEST(OpenClMemory, WithPlentyTheUnitIsWhole) {
  for (const BlockShape& shape : {kCpuShape, kGpuShape}) {
    const auto plan = plan_opencl_memory(shape, demand_of(64, 64, 16), {kPlenty, kPlenty}, "it");
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->part_width, 64);
    EXPECT_EQ(plan->part_height, 64);
    EXPECT_EQ(plan->items, shape.blocks ? 4 : 64 * 64 * 16);
    EXPECT_EQ(plan->slots, shape.blocks ? shape.slots : 64 * 64 * 16);
  }
}

TEST(OpenClMemory, WhateverIsPlannedFitsAndCanRender) {
  int refused = 0, planned = 0;
  for (const BlockShape& shape : {kCpuShape, kGpuShape})
    for (const auto& [width, height] : {std::pair{1, 1}, {64, 64}, {2048, 3}, {3, 2048}, {2048, 2048}})
      for (const int samples : {1, 16, 4096})
        for (std::uint64_t allocation = 1000; allocation < kPlenty; allocation *= 7)
          for (const std::uint64_t times : {1, 3, 10}) {
            const OpenClLimits limits{allocation * times, allocation};
            const OpenClDemand demand = demand_of(width, height, samples);
            const auto plan = plan_opencl_memory(shape, demand, limits, "it");
            if (!plan) {
              ++refused;
              EXPECT_THAT(plan.error().message, HasSubstr(std::to_string(limits.allocation)));
              EXPECT_THAT(plan.error().message, HasSubstr(std::to_string(limits.memory)));
              continue;
            }
            ++planned;
            std::uint64_t sum = demand.scene_bytes;
            for (const std::uint64_t bytes : {plan->path_bytes(demand), plan->slot_bytes(demand),
                                              plan->bad_bytes(demand), plan->result_bytes(demand)}) {
              EXPECT_GT(bytes, 0u);
              EXPECT_LE(bytes, limits.allocation);
              sum += bytes;
            }
            EXPECT_LE(sum, limits.memory);
            EXPECT_GE(plan->items, 1);
            EXPECT_GE(plan->finishing_items, 1);
            EXPECT_GE(plan->part_width, 1);
            EXPECT_LE(plan->part_width, width);
            EXPECT_GE(plan->part_height, 1);
            EXPECT_LE(plan->part_height, height);
            EXPECT_GE(plan->slots, samples) << "a pixel's samples stay together";
            EXPECT_EQ(plan->paths % shape.lanes, 0);
            if (!shape.blocks) {
              EXPECT_EQ(plan->slots % samples, 0);
              EXPECT_LE(plan->finishing_items, plan->slots / samples);
            }
          }
  EXPECT_GT(refused, 10);
  EXPECT_GT(planned, 100);
}

TEST(OpenClMemory, ASceneThatIsTooLargeIsNamedWithBothNumbers) {
  OpenClDemand demand = demand_of(64, 64, 16);
  demand.scene_bytes = 123456789;
  const auto plan = plan_opencl_memory(kCpuShape, demand, {200000000, 98765432}, "the abacus");
  ASSERT_FALSE(plan);
  for (const char* part : {"scene", "123456789", "98765432", "200000000", "the abacus"})
    EXPECT_THAT(plan.error().message, HasSubstr(part));
}

TEST(OpenClLaunch, FindsTheSizeOfAQuarterOfASecond) {
  // 1 us a path: 250 000 paths a launch, from either side, and then for good.
  for (const std::int64_t first : {std::int64_t(1), std::int64_t(1) << 40}) {
    LaunchSize size = LaunchSize::timed(0.25, first);
    for (int i = 0; i < 40; ++i) size.took(size.paths(), double(size.paths()) * 1e-6);
    EXPECT_NEAR(double(size.paths()), 250000, 2);
  }
}

TEST(OpenClLaunch, GrowsCarefullyAndShrinksAtOnce) {
  LaunchSize size = LaunchSize::timed(0.25, 1000);
  size.took(1000, 1e-9);  // empty pixels
  EXPECT_EQ(size.paths(), 4000);
  size.took(4000, 25.0);  // a hundred times too long
  EXPECT_EQ(size.paths(), 40);
  size.took(1, 1e-9);  // what is left of a unit says nothing
  EXPECT_EQ(size.paths(), 40);
  size.took(1, 100.0);
  EXPECT_EQ(size.paths(), 1) << "never less than a path";
}

TEST(OpenClLaunch, AFixedSizeStays) {
  LaunchSize size = LaunchSize::fixed(7);
  size.took(7, 100);
  EXPECT_EQ(size.paths(), 7);
  EXPECT_FALSE(size.is_timed());
}

}  // namespace
}  // namespace penumbra
