// Limits on metrics, for `penumbra compare --fail-above METRIC=VALUE`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scheduler/image/compare.h"

namespace penumbra {

struct CompareLimit {
  std::string metric;  ///< one of limit_metrics()
  double value = 0;    ///< the largest acceptable value
};

/// The names of metrics that can have a limit.
std::vector<std::string> limit_metrics();

/// Parses "METRIC=VALUE". Errors: another form, an unknown metric, a value that is negative or not finite.
Expected<CompareLimit> parse_limit(std::string_view text);

/// The metric over all channels. For bias and relative_bias it is the largest magnitude of a channel, so that
/// signs do not cancel. Errors: the metric was not computed; the message says why.
Expected<double> limited_value(const Comparison& comparison, std::string_view metric);

}  // namespace penumbra
