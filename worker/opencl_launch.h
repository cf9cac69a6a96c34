// The number of paths in one kernel launch.
#pragma once

#include <algorithm>
#include <cstdint>

namespace penumbra {

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
