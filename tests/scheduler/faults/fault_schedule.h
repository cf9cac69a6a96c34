// The faults of one run. They depend on a seed alone.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "tests/scheduler/faults/rogue_worker.h"

namespace penumbra {

/// To one of the worker processes that are there at that time.
struct ProcessFault {
  std::chrono::milliseconds at{0};  ///< from the first result on
  int signal = 0;
  int victim = 0;                                    ///< the so many-th, modulo how many there are
  std::optional<std::chrono::milliseconds> wake_up;  ///< of one that is stopped, from then on
};

struct FaultSchedule {
  unsigned seed = 0;
  int workers = 2;  ///< processes
  int tile = 16;
  int delay_ms = 5;               ///< of the processes, for each unit
  double verify = 0;              ///< all units, where somebody lies
  std::optional<int> crash_tile;  ///< counted row by row: its unit of the second pass kills every process
  std::vector<ProcessFault> processes;
  std::vector<RogueHabit> rogues;

  static FaultSchedule of(unsigned seed);
  [[nodiscard]] std::string text() const;
};

}  // namespace penumbra
