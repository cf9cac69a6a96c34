// Shared memory through which the scheduler's process and that of its simulated workers exchange counters.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace penumbra {

/// Latencies by their logarithm: 16 steps to a factor of two, so 4% wide, from a microsecond on.
class LatencyHistogram {
 public:
  void add(double seconds) {
    const double step = kStepsPerOctave * std::log2(std::max(seconds * 1e6, 1.0));
    ++counts_[std::min(std::size_t(step), counts_.size() - 1)];
  }
  /// Seconds below which this share of all are; 0 where there are none.
  [[nodiscard]] double quantile(double share) const {
    std::uint64_t all = 0, below = 0;
    for (const auto& count : counts_) all += count;
    for (std::size_t step = 0; step < counts_.size(); ++step) {
      below += counts_[step];
      if (double(below) >= share * double(all) && below > 0)
        return std::exp2((double(step) + 0.5) / kStepsPerOctave) * 1e-6;
    }
    return 0;
  }
  [[nodiscard]] std::uint64_t count() const {
    std::uint64_t all = 0;
    for (const auto& count : counts_) all += count;
    return all;
  }

 private:
  static constexpr double kStepsPerOctave = 16;
  std::array<std::atomic<std::uint64_t>, 480> counts_{};  // to a thousand seconds
};

struct LoadBoard {
  // Set before the workers' process starts.
  int workers = 1;
  double unit_seconds = 0;  ///< what a unit takes a worker in the mean
  std::uint64_t units = 0;  ///< of the job; what is ordered then are copies
  int planes = 6;           ///< of results
  int deaths = 0;           ///< so many workers break their connections with units in hand

  std::atomic<int> connected = 0;
  std::atomic<std::uint64_t> ordered = 0;
  LatencyHistogram orders;        ///< from sending a result to the order that comes for it
  LatencyHistogram redispatches;  ///< from a worker's death until another one is ordered to do its unit
};

/// The environment variable that names the file of the board.
inline constexpr const char* kBoardVariable = "PENUMBRA_LOAD_BOARD";

}  // namespace penumbra
