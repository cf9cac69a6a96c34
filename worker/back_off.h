// Pauses between attempts to reach a scheduler.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>
#include <utility>

namespace penumbra {

/// Exponential back-off with jitter: each pause is uniform between half of a limit and the limit, which
/// doubles up to `most`. So workers that lose their scheduler together do not reconnect together, and none
/// waits much longer than necessary.
class BackOff {
 public:
  using Duration = std::chrono::milliseconds;

  BackOff(Duration first, Duration most, std::uint32_t seed)
      : first_(first), most_(most), limit_(first), random_(seed) {}

  Duration next() {
    const Duration limit = std::exchange(limit_, std::min(limit_ * 2, most_));
    return Duration(std::uniform_int_distribution<Duration::rep>(limit.count() / 2, limit.count())(random_));
  }
  /// To be called after a successful connection.
  void reset() { limit_ = first_; }

 private:
  const Duration first_, most_;
  Duration limit_;
  std::minstd_rand random_;
};

}  // namespace penumbra
