// Validators of option values. Their limits are also shown in the help. Numbers are read as by `--set`: the
// whole word must be a number, and neither NaN nor infinite.
#pragma once

#include <cstdint>

#include "worker/cli/command_line.h"

namespace penumbra {

constexpr int kMaxWorkers = 1024;

OptionCheck whole_number(std::int64_t low, std::int64_t high);
OptionCheck number_between(double low, double high);
OptionCheck positive_number();
OptionCheck number_from_zero();

/// A number from zero with its unit s, m, h or d, as in "90m"; becomes seconds. For Option::transform.
OptionCheck duration();

/// The same for options in seconds that had no unit before: a number without one is left as it is.
OptionCheck seconds();

/// Not empty.
OptionCheck some_text();
/// NAME=VALUE, NAME not empty.
OptionCheck assignment();

}  // namespace penumbra
