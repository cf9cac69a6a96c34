// Pauses between attempts to reach a scheduler.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>
#include <utility>

namespace penumbra {

/// Each pause is random, evenly between half of a limit and all of it; the limit doubles up to a most. So
/// workers that lose their scheduler together do not come back together, and none waits for much longer than
/// it has to.
class BackOff {
 public:
  using Duration = std::chrono::milliseconds;

  BackOff(Duration first, Duration most, std::uint32_t seed)
      : first_(first), most_(most), limit_(first), random_(seed) {}

  Duration next() {
    const Duration limit = std::exchange(limit_, std::min(limit_ * 2, most_));
    return Duration(std::uniform_int_distribution<Duration::rep>(limit.count() / 2, limit.count())(random_));
  }
  /// There was a connection.
  void reset() { limit_ = first_; }

 private:
  const Duration first_, most_;
  Duration limit_;
  std::minstd_rand random_;
};

}  // namespace penumbra
