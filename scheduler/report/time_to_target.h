// The cost at which a method reaches a given error.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "scheduler/report/slope_fit.h"

namespace penumbra {

/// Only what was measured: nothing is extrapolated.
struct TimeToTarget {
  enum class Kind {
    kMeasured,    ///< `cost` reaches the target
    kShorter,     ///< the shortest run is below the target already; `cost` is that run's
    kNotReached,  ///< the longest run is above the target; `cost` is that run's
  } kind = Kind::kMeasured;
  double cost = 0;  ///< in the unit of the points
};

/// Interpolates linearly in log error over log cost between the points where the error last falls below
/// `target`. Points whose error or cost is not positive and finite are left out; the others may be in any
/// order. Nothing if no point is left, or the target is not positive.
std::optional<TimeToTarget> time_to_target(std::span<const CostError> points, double target);

/// The index of the method that certainly reaches the target first: its cost is at most what each other
/// method needs at least. Nothing if that is not known, or with fewer than two methods.
std::optional<std::size_t> fastest(std::span<const std::optional<TimeToTarget>> times);

}  // namespace penumbra
