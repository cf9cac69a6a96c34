// Runs cases on backends.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "scheduler/stress/backend.h"
#include "scheduler/stress/verdict.h"

namespace penumbra::stress {

/// The results, in the order of the cases; these must outlive them. Backends that are not there leave
/// skipped outcomes. `progress` is told each case before it is measured.
std::vector<CaseResult> run_cases(std::span<const Case> cases, std::span<Backend> backends,
                                  const std::function<void(const Case&)>& progress);

}  // namespace penumbra::stress
