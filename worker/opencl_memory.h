// Plans how much of a unit an OpenCL device renders at once, so that everything fits the device's memory, and
// how many paths one kernel launch has.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "kernels/host/device_scene.h"

namespace penumbra {

/// A CPU device runs blocks of thousands of paths, 16 per vectorised loop; each work item takes one block
/// after the other. Other devices run one path per work item; neighbouring items are adjacent in memory.
struct BlockShape {
  bool blocks = true;  ///< false: one path per work item
  int lanes = 16;
  int paths = kBlockPaths +
              16;  ///< paths per block; not a power of two, which would map fields to the same cache set
  int slots = int(kMaxSamplesPerUnit) + 16;  ///< samples per block
};
constexpr BlockShape kCpuShape{};
constexpr BlockShape kGpuShape{.blocks = false, .lanes = 1, .paths = 1, .slots = 0};

/// Limits in bytes, of a device, its driver or a test.
struct OpenClLimits {
  std::uint64_t memory = 0;      ///< total
  std::uint64_t allocation = 0;  ///< per buffer
};

/// What must fit.
struct OpenClDemand {
  std::uint64_t scene_bytes = 0;
  std::uint64_t photon_bytes = 0;  ///< photon maps, in a buffer of their own
  std::uint64_t path_words = 0;    ///< words of 4 bytes per path under way
  std::uint64_t slot_words = 0;    ///< words per sample until its pixel is finished
  std::uint64_t planes = 0;        ///< floats per pixel of the result
  std::uint64_t bad_bytes = 0;     ///< counters per work item
  int width = 0, height = 0;       ///< the unit's size in pixels
  int samples = 0;                 ///< samples per pixel
  int items = 1;                   ///< CPU: work items that keep the device busy
};

struct OpenClMemoryPlan {
  int part_width = 0, part_height = 0;  ///< the unit is rendered in parts of this size, in pixels
  int items = 0;                        ///< work items per launch; with one path per item: paths per launch
  int paths = 0;                        ///< stride of a block's state
  int slots = 0;                        ///< per block; with one path per item: for all paths together
  int finishing_items = 0;              ///< work items that have counters

  [[nodiscard]] std::uint64_t path_bytes(const OpenClDemand& demand) const;
  [[nodiscard]] std::uint64_t slot_bytes(const OpenClDemand& demand) const;
  [[nodiscard]] std::uint64_t bad_bytes(const OpenClDemand& demand) const;
  [[nodiscard]] std::uint64_t result_bytes(const OpenClDemand& demand) const;
  bool blocks = true;

  friend bool operator==(const OpenClMemoryPlan&, const OpenClMemoryPlan&) = default;
};

/// Plans the whole unit and all wanted work items if they fit; else fewer items, smaller blocks, and the unit
/// in parts. The error says what does not fit, with both numbers.
Expected<OpenClMemoryPlan> plan_opencl_memory(const BlockShape& shape, const OpenClDemand& demand,
                                              const OpenClLimits& limits, const std::string& device);

/// Learns from the times of launches how many paths the next may have. Watchdogs of drivers kill kernels that
/// block a display for about 2 s.
class LaunchSize {
 public:
  /// A constant size.
  static LaunchSize fixed(std::int64_t paths) { return {paths, 0}; }
  /// A size that grows from `first` so that a launch takes about `seconds`.
  static LaunchSize timed(double seconds, std::int64_t first) { return {first, seconds}; }

  [[nodiscard]] bool is_timed() const { return seconds_ > 0; }
  [[nodiscard]] std::int64_t paths() const { return paths_; }

  /// Reports that a launch of `paths` paths took `seconds`. Costs of paths differ, so growth is limited, and
  /// a launch that took too long reduces the size at once.
  void took(std::int64_t paths, double seconds) {
    if (!is_timed() || paths <= 0) return;
    constexpr double kFastest = 1e-6;
    const double wanted = double(paths) * seconds_ / std::max(seconds, kFastest);
    constexpr double kGrowth = 4, kMost = 1e15;
    if (wanted < double(paths_)) {
      // A small launch says little about a large one.
      if (seconds > seconds_ || 2 * paths >= paths_) paths_ = std::max<std::int64_t>(1, std::int64_t(wanted));
    } else if (2 * paths >= paths_) {
      paths_ = std::int64_t(std::min({wanted, kGrowth * double(paths_), kMost}));
    }
  }

 private:
  LaunchSize(std::int64_t paths, double seconds)
      : paths_(std::max<std::int64_t>(1, paths)), seconds_(seconds) {}

  std::int64_t paths_;
  double seconds_;  // 0: not timed
};

}  // namespace penumbra
