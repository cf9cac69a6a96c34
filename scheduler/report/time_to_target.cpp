#include "scheduler/report/time_to_target.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace penumbra {

std::optional<TimeToTarget> time_to_target(std::span<const CostError> points, double target) {
  using Kind = TimeToTarget::Kind;
  std::vector<CostError> curve;
  for (const CostError& point : points) {
    if (point.cost > 0 && point.error > 0 && std::isfinite(point.cost) && std::isfinite(point.error))
      curve.push_back(point);
  }
  if (!(target > 0) || curve.empty()) return std::nullopt;
  std::ranges::sort(curve, {}, &CostError::cost);
  if (curve.back().error > target) return TimeToTarget{Kind::kNotReached, curve.back().cost};
  // Finds the last crossing of the target; after it the error stays below.
  for (std::size_t i = curve.size(); i-- > 1;) {
    const CostError &above = curve[i - 1], &below = curve[i];
    if (above.error <= target) continue;
    const double part =
        (std::log(above.error) - std::log(target)) / (std::log(above.error) - std::log(below.error));
    return TimeToTarget{Kind::kMeasured, std::exp(std::log(above.cost) +
                                                  part * (std::log(below.cost) - std::log(above.cost)))};
  }
  return TimeToTarget{curve.front().error == target ? Kind::kMeasured : Kind::kShorter, curve.front().cost};
}

std::optional<std::size_t> fastest(std::span<const std::optional<TimeToTarget>> times) {
  using Kind = TimeToTarget::Kind;
  const auto least = [](const TimeToTarget& time) { return time.kind == Kind::kShorter ? 0 : time.cost; };
  const auto most = [](const TimeToTarget& time) {
    return time.kind == Kind::kNotReached ? INFINITY : time.cost;
  };
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!times[i] || most(*times[i]) == INFINITY) continue;
    bool first = true, compared = false;
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (k == i || !times[k]) continue;
      compared = true;
      first = first && most(*times[i]) <= least(*times[k]);
    }
    if (first && compared) return i;
  }
  return std::nullopt;
}

}  // namespace penumbra
