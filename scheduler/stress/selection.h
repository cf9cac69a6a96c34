// Selects cases by the patterns of `--case`.
#pragma once

#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/stress/case.h"

namespace penumbra::stress {

/// Whether a name matches: as a glob if the pattern contains * or ?, else as a substring.
bool matches(std::string_view name, std::string_view pattern);

/// The cases that match any of the patterns, in their order; all if there are no patterns. Error: a pattern
/// that matches none.
Expected<std::vector<Case>> select(std::vector<Case> cases, const std::vector<std::string>& patterns);

}  // namespace penumbra::stress
