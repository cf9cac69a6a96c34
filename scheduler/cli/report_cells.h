// Renders the cells of a report, each through the scheduler like any job, and keeps what is finished.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "scheduler/cli/report_plan.h"

namespace penumbra {

struct CellRun {
  bool stopped = false;               ///< by the user; what is finished is kept
  std::vector<std::string> failures;  ///< cells that could not be rendered, and why
  std::size_t rendered = 0, found = 0, total = 0;
};

struct CellRunOptions {
  std::string worker_executable;
  int repeats = 1;
  bool quiet = false;
};

/// Renders every cell that the store has not: references first, then the curves side by side, small budgets
/// first, so that all methods see the same times of the machine. A cell that fails does not keep the others.
CellRun run_cells(const std::vector<ScenePlan>& plans, const CellStore& store, const CellRunOptions& options,
                  const std::atomic<bool>& stop);

}  // namespace penumbra
