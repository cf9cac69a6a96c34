// The scheduler under load: one job with simulated workers, and its cost.
#pragma once

#include <cstdint>
#include <string>

#include "kernels/host/error.h"

namespace penumbra {

struct LoadSettings {
  int workers = 10;
  int units = 20000;  ///< at least: as many whole passes as that takes
  double unit_seconds = 0;
  int tile = 16;               ///< pixels along a side of a unit
  int side = 64;               ///< tiles along a side of the film
  std::uint64_t features = 0;  ///< FEATURE_* bits that results have layers of
  int deaths = 0;
};

struct LoadFigures {
  std::uint64_t units = 0;
  std::uint64_t bytes_per_result = 0;
  double units_per_second = 0;          ///< between the first progress and the last; 0: too short to say
  double cpu_seconds_per_unit = 0;      ///< of the scheduler's process
  double order_p50 = 0, order_p99 = 0;  ///< seconds from a result that is sent to the order that comes for it
  double redispatch_p50 = 0, redispatch_most = 0;  ///< seconds from a death to the order of the lost unit
  double bytes_per_idle_worker = 0;                ///< resident, of the scheduler's process
  std::uint64_t peak_bytes = 0;                    ///< likewise, in all
  double overhead = 0;  ///< of the farm: time over the units' own, less 1; 0 where they take none
};

/// `program`: this one, which runs the simulated workers when it is started with --connect. Error: a unit or
/// a pixel is not what it should be.
Expected<LoadFigures> run_load(const LoadSettings& settings, const std::string& program);

}  // namespace penumbra
