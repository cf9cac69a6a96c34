// How much of a unit an OpenCL device takes at once, so that all of it fits the device's memory.
#pragma once

#include <cstdint>
#include <string>

#include "kernels/host/device_scene.h"

namespace penumbra {

/// A CPU device runs blocks of thousands of paths, 16 to a loop; each work item takes one after the other.
/// Any other device runs a path a work item, and neighbouring items lie side by side in memory.
struct BlockShape {
  bool blocks = true;  ///< false: a path a work item
  int lanes = 16;
  int paths = kBlockPaths + 16;              ///< of a block; no power of two, for the cache's sake
  int slots = int(kMaxSamplesPerUnit) + 16;  ///< samples of a block
};
constexpr BlockShape kCpuShape{};
constexpr BlockShape kGpuShape{.blocks = false, .lanes = 1, .paths = 1, .slots = 0};

/// Bytes; what a device, its driver or a test allows.
struct OpenClLimits {
  std::uint64_t memory = 0;      ///< altogether
  std::uint64_t allocation = 0;  ///< of one buffer
};

/// What is to be held.
struct OpenClDemand {
  std::uint64_t scene_bytes = 0;
  std::uint64_t path_words = 0;  ///< 4 bytes each, of a path under way
  std::uint64_t slot_words = 0;  ///< of a sample until its pixel is finished
  std::uint64_t planes = 0;      ///< floats of a pixel's result
  std::uint64_t bad_bytes = 0;   ///< counters of a work item
  int width = 0, height = 0;     ///< pixels of the unit
  int samples = 0;               ///< of a pixel
  int items = 1;                 ///< CPU: work items that keep the device busy
};

struct OpenClMemoryPlan {
  int part_width = 0, part_height = 0;  ///< the unit is rendered in parts of so many pixels
  int items = 0;                        ///< work items of a launch; with a path an item: paths of a launch
  int paths = 0;                        ///< stride of a block's state
  int slots = 0;                        ///< of a block; with a path an item: of all paths together
  int finishing_items = 0;              ///< those that have counters

  [[nodiscard]] std::uint64_t path_bytes(const OpenClDemand& demand) const;
  [[nodiscard]] std::uint64_t slot_bytes(const OpenClDemand& demand) const;
  [[nodiscard]] std::uint64_t bad_bytes(const OpenClDemand& demand) const;
  [[nodiscard]] std::uint64_t result_bytes(const OpenClDemand& demand) const;
  bool blocks = true;

  friend bool operator==(const OpenClMemoryPlan&, const OpenClMemoryPlan&) = default;
};

/// The whole unit and as many work items as are wanted if they fit, else fewer items, smaller blocks, and the
/// unit in parts. The error says what does not fit and both numbers.
Expected<OpenClMemoryPlan> plan_opencl_memory(const BlockShape& shape, const OpenClDemand& demand,
                                              const OpenClLimits& limits, const std::string& device);

}  // namespace penumbra
