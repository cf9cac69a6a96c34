// How long a method needs to get down to a given error.
#pragma once

#include <optional>
#include <span>

#include "scheduler/report/slope_fit.h"

namespace penumbra {

struct TimeToTarget {
  double cost = 0;            ///< in the points' unit
  bool extrapolated = false;  ///< outside of what was measured, along the fitted line
};

/// Linear in log error over log cost between the points where the error last falls to `target`; points whose
/// error or cost is not positive and finite are left out. Outside of the points it follows `fit`, if there is
/// one that falls. Nothing where there is no answer. The points may be in any order.
std::optional<TimeToTarget> time_to_target(std::span<const CostError> points,
                                           const std::optional<SlopeFit>& fit, double target);

}  // namespace penumbra
