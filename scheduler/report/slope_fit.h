// How fast an error falls: a power law through the points of a curve.
#pragma once

#include <optional>
#include <span>

namespace penumbra {

/// One budget of a curve: what it cost (seconds, or samples per pixel) and how large the error was.
struct CostError {
  double cost = 0, error = 0;
};

/// error = exp(intercept) cost^slope, by least squares of log error on log cost.
struct SlopeFit {
  double slope = 0, intercept = 0;
  double low = 0, high = 0;  ///< confidence interval of the slope
  double confidence = 0;     ///< of that interval
  double residual = 0;       ///< standard deviation of log error about the line
  int points = 0;            ///< that were used: those whose cost and error are positive and finite

  [[nodiscard]] double error_at(double cost) const;
  /// Infinite where the error does not fall.
  [[nodiscard]] double cost_of(double error) const;
  [[nodiscard]] bool holds(double slope_value) const { return low <= slope_value && slope_value <= high; }
};

constexpr double kConfidence = 0.95;
constexpr int kFewestFitPoints = 3;  ///< two points have a slope but no idea of its error

/// Nothing where fewer than kFewestFitPoints points can be used, or all have the same cost. The interval is
/// slope ± t SE with the t quantile of n - 2 degrees of freedom: right where the errors of log error are
/// independent, normal and of one size.
std::optional<SlopeFit> fit_slope(std::span<const CostError> points, double confidence = kConfidence);

}  // namespace penumbra
