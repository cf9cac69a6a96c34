// Logarithmic axes of gnuplot plots: ranges and readable ticks.
#pragma once

#include <cmath>
#include <set>
#include <string>

namespace penumbra {

/// The positive finite values that an axis must show.
struct AxisRange {
  double low = INFINITY, high = 0;

  void include(double value);
  [[nodiscard]] bool empty() const { return !(high > 0); }
  /// With space beside the outermost values.
  [[nodiscard]] AxisRange widened() const;
};

/// "0.05"; powers of ten far from 1 as "10⁻⁵", "2·10⁻⁵".
std::string tick_text(double value);

/// The gnuplot commands that set range and ticks of the axis x or y: 1-2-5 steps, or powers of ten for long
/// ranges; at most about `most_labels` of them. Empty for an empty range.
std::string axis_script(char axis, const AxisRange& range, int most_labels);

/// The x axis with ticks at the budgets in samples per pixel, or at every second, fourth, … of them.
std::string budget_axis_script(const std::set<double>& budgets);

}  // namespace penumbra
