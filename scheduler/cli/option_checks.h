// Validators of option values. Their limits are also shown in the help. Numbers are read as by `--set`: the
// whole word must be a number, and neither NaN nor infinite.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace penumbra {

constexpr int kMaxWorkers = 1024;

CLI::Validator whole_number(std::int64_t low, std::int64_t high);
CLI::Validator number_between(double low, double high);
CLI::Validator positive_number();
CLI::Validator number_from_zero();

/// A number from zero with its unit s, m, h or d, as in "90m"; becomes seconds. For CLI::Option::transform.
CLI::Validator duration();

/// Not empty.
CLI::Validator some_text();
/// NAME=VALUE, NAME not empty.
CLI::Validator assignment();

}  // namespace penumbra
