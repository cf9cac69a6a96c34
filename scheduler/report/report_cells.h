// Renders the cells of a report through the scheduler, and stores each that is finished.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "scheduler/report/report_plan.h"

namespace penumbra {

struct CellRun {
  bool stopped = false;               ///< stopped by the user; finished cells are kept
  std::vector<std::string> failures;  ///< the cells that could not be rendered, with the reasons
  std::size_t rendered = 0, found = 0, total = 0;
};

struct CellRunOptions {
  std::string worker_executable;
  int repeats = 1;
  bool quiet = false;
};

/// Renders every cell that the store lacks: first the references, then the curves side by side, from small to
/// large budgets, so that varying machine load affects all methods alike. If a cell fails, the others are
/// still rendered.
CellRun run_cells(const std::vector<ScenePlan>& plans, const CellStore& store, const CellRunOptions& options,
                  const std::atomic<bool>& stop);

}  // namespace penumbra
