// Limits of a comparison: what `penumbra compare --fail-above METRIC=VALUE` decides by.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scheduler/image/compare.h"

namespace penumbra {

struct CompareLimit {
  std::string metric;  ///< one of limit_metrics()
  double value = 0;    ///< the largest that is good enough
};

/// Names that a limit can have.
std::vector<std::string> limit_metrics();

/// "METRIC=VALUE". Errors: another form, no such metric, a value that is not finite or is negative.
Expected<CompareLimit> parse_limit(std::string_view text);

/// The metric of all channels together; of bias and relative_bias the largest magnitude of the channels, in
/// which signs do not cancel. Errors: it was left out; the message says why.
Expected<double> limited_value(const Comparison& comparison, std::string_view metric);

}  // namespace penumbra
