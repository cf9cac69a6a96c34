#include "scheduler/report/slope_fit.h"

#include <cmath>
#include <limits>
#include <vector>

#include "scheduler/image/metrics/distributions.h"

namespace penumbra {

double SlopeFit::error_at(double cost) const { return std::exp(intercept + slope * std::log(cost)); }

double SlopeFit::cost_of(double error) const {
  if (!(slope < 0)) return std::numeric_limits<double>::infinity();
  return std::exp((std::log(error) - intercept) / slope);
}

std::optional<SlopeFit> fit_slope(std::span<const CostError> points, double confidence) {
  struct Log {
    double x, y;
  };
  std::vector<Log> logs;
  for (const CostError& point : points) {
    const Log log{std::log(point.cost), std::log(point.error)};
    if (point.cost > 0 && point.error > 0 && std::isfinite(log.x) && std::isfinite(log.y))
      logs.push_back(log);
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

}  // namespace penumbra
