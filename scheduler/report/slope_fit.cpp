#include "scheduler/report/slope_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scheduler/image/metrics/distributions.h"

namespace penumbra {

double SlopeFit::error_at(double cost) const { return std::exp(intercept + slope * std::log(cost)); }

namespace {

bool has_logarithms(const CostError& point) {
  return point.cost > 0 && point.error > 0 && std::isfinite(point.cost) && std::isfinite(point.error);
}

}  // namespace

std::optional<SlopeFit> fit_slope(std::span<const CostError> points, double confidence) {
  struct Log {
    double x, y;
  };
  std::vector<Log> logs;
  for (const CostError& point : points) {
    if (has_logarithms(point)) logs.push_back({std::log(point.cost), std::log(point.error)});
  }
  const double n = double(logs.size());
  if (logs.size() < kFewestFitPoints) return std::nullopt;
  double mean_x = 0, mean_y = 0;
  for (const Log& log : logs) {
    mean_x += log.x / n;
    mean_y += log.y / n;
  }
  double xx = 0, xy = 0;
  for (const Log& log : logs) {
    xx += (log.x - mean_x) * (log.x - mean_x);
    xy += (log.x - mean_x) * (log.y - mean_y);
  }
  constexpr double kSameCost = 1e-20;  // limit on the sum of squares for costs that are equal up to rounding
  if (!(xx > kSameCost)) return std::nullopt;
  SlopeFit fit;
  fit.slope = xy / xx;
  fit.intercept = mean_y - fit.slope * mean_x;
  fit.confidence = confidence;
  fit.points = int(logs.size());
  double squares = 0;
  for (const Log& log : logs) {
    const double rest = log.y - (fit.intercept + fit.slope * log.x);
    squares += rest * rest;
  }
  fit.residual = std::sqrt(squares / (n - 2));
  const double half = student_t_quantile(0.5 + 0.5 * confidence, n - 2) * fit.residual / std::sqrt(xx);
  fit.low = fit.slope - half;
  fit.high = fit.slope + half;
  return fit;
}

Slope slope_of(std::span<const CostError> points, const std::string& costs) {
  int count = 0;
  double low = 0, high = 0;
  for (const CostError& point : points) {
    if (!has_logarithms(point)) continue;
    low = count == 0 ? point.cost : std::min(low, point.cost);
    high = std::max(high, point.cost);
    ++count;
  }
  if (count < kFewestFitPoints)
    return {{}, fmt::format("fewer than {} budgets above the reference's noise", kFewestFitPoints)};
  constexpr double kRounding = 1e-9;
  if (high < low * kSmallestSpan * (1 - kRounding))
    return {{}, fmt::format("{} span less than a factor of {:g}", costs, kSmallestSpan)};
  return {fit_slope(points), {}};
}

}  // namespace penumbra
