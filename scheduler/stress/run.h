// Runs cases on backends.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "scheduler/stress/backend.h"
#include "scheduler/stress/verdict.h"

namespace penumbra::stress {

/// Runs all cases on all backends. Results are in the order of the cases, which must outlive them.
/// Unavailable backends give skipped outcomes. `progress` is called with each case before it is measured.
std::vector<CaseResult> run_cases(std::span<const Case> cases, std::span<Backend> backends,
                                  const std::function<void(const Case&)>& progress);

}  // namespace penumbra::stress
