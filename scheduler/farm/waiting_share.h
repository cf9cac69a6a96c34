// Notices that workers wait for their scheduler.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "scheduler/plan/plan_messages.h"

namespace penumbra {

/// Measures how much of their time workers wait for units, although there are enough: then the scheduler or
/// its network is too slow for them. A pure function of what it is told.
class WaitingShare {
 public:
  /// Totals since the farm was started.
  struct Totals {
    double busy = 0;  ///< seconds that workers have spent on finished units
    std::uint64_t results = 0, bytes = 0;
    double cpu = 0;  ///< seconds of CPU time of this process
  };
  struct Measured {
    double waiting = 0;  ///< the share of their time, in [0, 1]
    double bytes_per_second = 0, cores = 0;
  };

  /// To be called about once a second. `has_enough`: there are units for all workers. Returns a measurement
  /// after at least kWindow seconds in which there always were, and enough results of each worker that units
  /// which are not finished do not matter. Then the next one begins.
  std::optional<Measured> measure(Seconds now, int workers, bool has_enough, const Totals& totals);

 private:
  static constexpr Seconds kWindow = 30;
  static constexpr std::uint64_t kResultsPerWorker = 10;

  std::optional<Seconds> begin_;
  Seconds last_ = 0;
  double worker_seconds_ = 0;
  int most_workers_ = 0;
  Totals before_;
};

/// Workers that wait more than this are worth a hint.
constexpr double kMuchWaiting = 0.25;

/// The hint. `pass`: the present samples per pixel of a result; `more`: what to try instead; 0: nothing.
std::string waiting_text(const WaitingShare::Measured& measured, std::uint32_t pass, std::uint32_t more);

}  // namespace penumbra
