#include "scheduler/report/time_to_target.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace penumbra {

std::optional<TimeToTarget> time_to_target(std::span<const CostError> points,
                                           const std::optional<SlopeFit>& fit, double target) {
  std::vector<CostError> curve;
  for (const CostError& point : points) {
    if (point.cost > 0 && point.error > 0 && std::isfinite(point.cost) && std::isfinite(point.error))
      curve.push_back(point);
  }
  if (!(target > 0) || curve.empty()) return std::nullopt;
  std::ranges::sort(curve, {}, &CostError::cost);
  // Finds the last crossing of the target; after it the error stays below.
  const bool reached = curve.back().error <= target;
  for (std::size_t i = curve.size(); reached && i-- > 1;) {
    const CostError &above = curve[i - 1], &below = curve[i];
    if (above.error <= target) continue;
    const double part =
        (std::log(above.error) - std::log(target)) / (std::log(above.error) - std::log(below.error));
    return TimeToTarget{std::exp(std::log(above.cost) + part * (std::log(below.cost) - std::log(above.cost))),
                        false};
  }
  if (curve.front().error == target) return TimeToTarget{curve.front().cost, false};
  if (!fit || !(fit->slope < 0)) return std::nullopt;
  const double cost = fit->cost_of(target);
  // The fitted line may disagree with the measured points, so it is used only beyond them.
  return TimeToTarget{reached ? std::min(cost, curve.front().cost) : std::max(cost, curve.back().cost), true};
}

}  // namespace penumbra
