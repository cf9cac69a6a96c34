// The cost at which a method reaches a given error.
#pragma once

#include <optional>
#include <span>

#include "scheduler/report/slope_fit.h"

namespace penumbra {

struct TimeToTarget {
  double cost = 0;            ///< in the unit of the points
  bool extrapolated = false;  ///< outside the measured range, from the fitted line
};

/// Interpolates linearly in log error over log cost between the points where the error last falls below
/// `target`. Points whose error or cost is not positive and finite are left out. Outside the measured range
/// it uses `fit`, if there is one with a falling error. Nothing if there is no answer. The points may be in
/// any order.
std::optional<TimeToTarget> time_to_target(std::span<const CostError> points,
                                           const std::optional<SlopeFit>& fit, double target);

}  // namespace penumbra
