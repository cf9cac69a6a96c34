// Which cases `--case` means.
#pragma once

#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/stress/case.h"

namespace penumbra::stress {

/// Whether a name matches: as a glob of * and ? if the pattern has any of them, else as a part of it.
bool matches(std::string_view name, std::string_view pattern);

/// The cases that match any pattern, all without one, in their order. Error: a pattern that matches none.
Expected<std::vector<Case>> select(std::vector<Case> cases, const std::vector<std::string>& patterns);

}  // namespace penumbra::stress
