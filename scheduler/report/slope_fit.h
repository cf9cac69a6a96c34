// Fits a power law to the points of a convergence curve.
#pragma once

#include <optional>
#include <span>
#include <string>

namespace penumbra {

/// A point: the cost (seconds, or samples per pixel) and the error.
struct CostError {
  double cost = 0, error = 0;
};

/// error = exp(intercept) cost^slope, by least squares of log error on log cost.
struct SlopeFit {
  double slope = 0, intercept = 0;
  double low = 0, high = 0;  ///< confidence interval of the slope
  double confidence = 0;     ///< of that interval
  double residual = 0;       ///< standard deviation of log error around the line
  int points = 0;            ///< number of points used: those with positive and finite cost and error

  [[nodiscard]] double error_at(double cost) const;
  [[nodiscard]] bool holds(double slope_value) const { return low <= slope_value && slope_value <= high; }
};

constexpr double kConfidence = 0.95;
constexpr int kFewestFitPoints = 3;  ///< two points determine a slope but not its uncertainty

/// Nothing if fewer than kFewestFitPoints points can be used, or if all have the same cost. The confidence
/// interval is slope ± t SE with the t quantile for n - 2 degrees of freedom. It is correct if the deviations
/// of log error are independent and normal with equal variance.
std::optional<SlopeFit> fit_slope(std::span<const CostError> points, double confidence = kConfidence);

/// A slope, or why none is given.
struct Slope {
  std::optional<SlopeFit> fit;
  std::string none_because;  ///< empty if there is a fit
};

constexpr double kSmallestSpan = 4;  ///< ratio of the largest cost to the smallest: two octaves

/// The fit, unless fewer than kFewestFitPoints points can be used or their costs span less than
/// kSmallestSpan. Over a shorter span the slope is mostly that of the noise. `costs` names the costs for the
/// reason: "times".
Slope slope_of(std::span<const CostError> points, const std::string& costs);

}  // namespace penumbra
