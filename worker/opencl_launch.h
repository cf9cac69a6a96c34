// How much work one kernel launch holds.
#pragma once

#include <algorithm>
#include <cstdint>

namespace penumbra {

/// Learns from the time that launches took how many paths the next may hold. A driver's watchdog ends kernels
/// that keep a display waiting, after some 2 s.
class LaunchSize {
 public:
  /// A constant size.
  static LaunchSize fixed(std::int64_t paths) { return {paths, 0}; }
  /// So that a launch takes about so many seconds, beginning with a small one.
  static LaunchSize timed(double seconds, std::int64_t first) { return {first, seconds}; }

  [[nodiscard]] bool is_timed() const { return seconds_ > 0; }
  [[nodiscard]] std::int64_t paths() const { return paths_; }

  /// A launch of so many paths took so long. Paths differ, so growth is careful and a launch that took too
  /// long counts at once.
  void took(std::int64_t paths, double seconds) {
    if (!is_timed() || paths <= 0) return;
    constexpr double kFastest = 1e-6;
    const double wanted = double(paths) * seconds_ / std::max(seconds, kFastest);
    constexpr double kGrowth = 4, kMost = 1e15;
    if (wanted < double(paths_)) {
      // A launch that was small anyway says little about a large one.
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
