#include "worker/opencl_memory.h"

#include <fmt/format.h>

#include <algorithm>

namespace penumbra {
namespace {

// With one path per work item: enough items to fill the largest devices, and samples whose slots take some 50
// to 100 MB.
constexpr int kMostItems = 1 << 18;
constexpr int kMostSlots = 1 << 20;
constexpr int kMostFinishingItems = 1 << 15;

bool fits(const OpenClMemoryPlan& plan, const OpenClDemand& demand, const OpenClLimits& limits) {
  std::uint64_t sum = demand.scene_bytes + demand.photon_bytes;
  bool each = true;
  for (const std::uint64_t bytes : {plan.path_bytes(demand), plan.slot_bytes(demand), plan.bad_bytes(demand),
                                    plan.result_bytes(demand)}) {
    each = each && bytes <= limits.allocation;
    sum += bytes;
  }
  return each && sum <= limits.memory;
}

OpenClMemoryPlan largest_plan(const BlockShape& shape, const OpenClDemand& demand) {
  OpenClMemoryPlan plan;
  plan.blocks = shape.blocks;
  plan.part_width = demand.width;
  plan.part_height = demand.height;
  if (shape.blocks) {
    plan.items = plan.finishing_items = demand.items;
    plan.paths = shape.paths;
    plan.slots = std::max(shape.slots, demand.samples + shape.lanes - 1);
    return plan;
  }
  const std::int64_t pixels = std::int64_t(demand.width) * demand.height;
  // Whole pixels.
  const std::int64_t slots = std::max<std::int64_t>(kMostSlots / demand.samples, 1) * demand.samples;
  plan.slots = int(std::min(slots, pixels * demand.samples));
  plan.items = plan.paths = std::min(plan.slots, kMostItems);
  plan.finishing_items = std::min(plan.slots / demand.samples, kMostFinishingItems);
  return plan;
}

/// Makes the largest item smaller. Returns false if nothing can be made smaller.
bool shrink(OpenClMemoryPlan& plan, const BlockShape& shape, const OpenClDemand& demand) {
  const auto halve = [](int& value, int least) {
    if (value <= least) return false;
    value = std::max(value / 2, least);
    return true;
  };
  const auto smaller_result = [&] { return halve(plan.part_height, 1) || halve(plan.part_width, 1); };
  const auto smaller_blocks = [&] {
    if (!plan.blocks) {
      bool any = halve(plan.items, 1);
      plan.paths = plan.items;
      if (plan.slot_bytes(demand) >= plan.path_bytes(demand) && plan.slots > demand.samples) {
        plan.slots = std::max(plan.slots / 2 / demand.samples, 1) * demand.samples;
        plan.finishing_items = std::min(plan.finishing_items, plan.slots / demand.samples);
        any = true;
      }
      return any;
    }
    if (halve(plan.items, 1)) {
      plan.finishing_items = plan.items;
      return true;
    }
    const int lanes = shape.lanes;
    bool any = halve(plan.slots, demand.samples + lanes - 1);
    if (plan.paths > lanes) {
      plan.paths = std::max(plan.paths / 2 / lanes, 1) * lanes;
      any = true;
    }
    return any;
  };
  const bool result_first = plan.result_bytes(demand) > plan.path_bytes(demand) + plan.slot_bytes(demand);
  return result_first ? smaller_result() || smaller_blocks() : smaller_blocks() || smaller_result();
}

}  // namespace

std::uint64_t OpenClMemoryPlan::path_bytes(const OpenClDemand& demand) const {
  return std::uint64_t(blocks ? items : 1) * std::uint64_t(paths) * demand.path_words * 4;
}
std::uint64_t OpenClMemoryPlan::slot_bytes(const OpenClDemand& demand) const {
  return std::uint64_t(blocks ? items : 1) * std::uint64_t(slots) * demand.slot_words * 4;
}
std::uint64_t OpenClMemoryPlan::bad_bytes(const OpenClDemand& demand) const {
  return std::uint64_t(finishing_items) * demand.bad_bytes;
}
std::uint64_t OpenClMemoryPlan::result_bytes(const OpenClDemand& demand) const {
  return std::uint64_t(part_width) * std::uint64_t(part_height) * demand.planes * 4;
}

Expected<OpenClMemoryPlan> plan_opencl_memory(const BlockShape& shape, const OpenClDemand& demand,
                                              const OpenClLimits& limits, const std::string& device) {
  const std::uint64_t scene_bytes = demand.scene_bytes + demand.photon_bytes;
  if (std::max(demand.scene_bytes, demand.photon_bytes) > limits.allocation || scene_bytes > limits.memory)
    return fail(fmt::format("{} {} bytes, and {} allows {} in one buffer and {} altogether",
                            demand.photon_bytes > 0 ? "the scene and its photons take" : "the scene takes",
                            scene_bytes, device, limits.allocation, limits.memory));
  OpenClMemoryPlan plan = largest_plan(shape, demand);
  while (!fits(plan, demand, limits)) {
    if (!shrink(plan, shape, demand)) {
      const std::uint64_t needed = plan.path_bytes(demand) + plan.slot_bytes(demand) +
                                   plan.bad_bytes(demand) + plan.result_bytes(demand);
      return fail(
          fmt::format("one pixel of {} samples takes {} bytes beside the scene's {}, and {} allows {} in one "
                      "buffer and {} "
                      "altogether; fewer samples in a pass (--pass) take less",
                      demand.samples, needed, scene_bytes, device, limits.allocation, limits.memory));
    }
  }
  return plan;
}

}  // namespace penumbra
