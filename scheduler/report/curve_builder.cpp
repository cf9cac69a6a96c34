#include "scheduler/report/curve_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

PhaseSeconds median_seconds(const std::vector<ImageResult>& images) {
  const auto of = [&](double PhaseSeconds::*phase) {
    std::vector<double> values;
    for (const ImageResult& image : images) values.push_back(image.seconds.*phase);
    return median(std::move(values));
  };
  return {of(&PhaseSeconds::build), of(&PhaseSeconds::transfer), of(&PhaseSeconds::render),
          of(&PhaseSeconds::total)};
}

ImageErrors mean_errors(const std::vector<ImageResult>& images) {
  ImageErrors mean;
  const double share = 1.0 / double(images.size());
  for (const ImageResult& image : images) {
    mean.mse += image.errors.mse * share;
    mean.relative_mse += image.errors.relative_mse * share;
    mean.trimmed_relative_mse += image.errors.trimmed_relative_mse * share;
    mean.block_relative_mse += image.errors.block_relative_mse * share;
    mean.mape += image.errors.mape * share;
    mean.smape += image.errors.smape * share;
    mean.bias += image.errors.bias * share;
    mean.largest = std::max(mean.largest, image.errors.largest);
    mean.non_finite = std::max(mean.non_finite, image.errors.non_finite);
  }
  return mean;
}

/// If errors fall as 1 / T, the efficiency 1 / (error T) is constant along the curve. Otherwise it
/// characterises a budget, not a method, and is not reported.
void find_efficiency(const ReportData& report, Curve& curve) {
  const auto& fit = curve.mse_over_time;
  if (!fit) {
    curve.no_efficiency = "no slope";
    return;
  }
  if (!fit->holds(-1)) {
    curve.no_efficiency = "slope is not -1";
    return;
  }
  double sum = 0;
  int count = 0;
  for (const CostError& point : over_time(report, curve, false)) {
    if (!(point.cost > 0 && point.error > 0)) continue;
    sum -= std::log(point.cost * point.error);
    ++count;
  }
  curve.efficiency = std::exp(sum / count);
}

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

ImageErrors measure_errors(const ImagePair& pair, double epsilon) {
  ImageErrors errors;
  errors.mse = mean_squared_error(pair).overall;
  errors.relative_mse = relative_mse(pair, epsilon).overall;
  errors.trimmed_relative_mse = trimmed_relative_mse(pair, epsilon).overall;
  errors.block_relative_mse = block_relative_mse(pair, epsilon).overall;
  errors.mape = mean_absolute_percentage_error(pair, epsilon).overall;
  errors.smape = symmetric_mean_absolute_percentage_error(pair, epsilon).overall;
  errors.bias = bias(pair).overall;
  errors.largest = largest_difference(pair).value;
  errors.non_finite = pair.pixels() - pair.compared_pixels;
  return errors;
}

Expected<CurvePoint> measure_point(std::uint32_t spp, std::vector<ImageResult> images,
                                   const Reference& reference, double epsilon,
                                   const std::function<void(const ImagePair&)>& on_pair) {
  CurvePoint point;
  point.spp = spp;
  point.images = std::move(images);
  SeedStatistics seeds;
  for (ImageResult& result : point.images) {
    const auto image = read_image(result.file);
    if (!image) return std::unexpected(image.error());
    const auto pair = reference.pair(*image);
    if (!pair)
      return fail(fmt::format("{} against the reference: {}", result.file.string(), pair.error().message));
    result.errors = measure_errors(*pair, epsilon);
    seeds.add(*pair);
    if (on_pair) on_pair(*pair);
  }
  point.seconds = median_seconds(point.images);
  point.errors = mean_errors(point.images);
  point.squared = seeds.squared();
  point.relative = seeds.relative(epsilon);
  return point;
}

std::vector<CostError> over_time(const ReportData& report, const Curve& curve, bool relative) {
  std::vector<CostError> points;
  for (const CurvePoint& point : curve.points) {
    points.push_back(
        {report.seconds(point.seconds), relative ? point.errors.relative_mse : point.errors.mse});
  }
  return points;
}

std::vector<CostError> over_spp(const Curve& curve, bool relative) {
  std::vector<CostError> points;
  for (const CurvePoint& point : curve.points) {
    if (point.spp > 0)
      points.push_back({double(point.spp), relative ? point.errors.relative_mse : point.errors.mse});
  }
  return points;
}

double error_at_time(const ReportData& report, const Curve& curve, double seconds) {
  std::vector<CostError> points = over_time(report, curve, true);
  std::erase_if(points, [](const CostError& p) { return !(p.cost > 0 && p.error > 0); });
  std::ranges::sort(points, {}, &CostError::cost);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const CostError &before = points[i - 1], &after = points[i];
    if (!(before.cost <= seconds && seconds <= after.cost) || before.cost == after.cost) continue;
    const double part = std::log(seconds / before.cost) / std::log(after.cost / before.cost);
    return before.error * std::pow(after.error / before.error, part);
  }
  return std::nan("");
}

void finish_curve(const ReportData& report, std::span<const Target> targets, Curve& curve) {
  curve.mse_over_time = fit_slope(over_time(report, curve, false));
  curve.relmse_over_time = fit_slope(over_time(report, curve, true));
  curve.mse_over_spp = fit_slope(over_spp(curve, false));
  curve.relmse_over_spp = fit_slope(over_spp(curve, true));
  curve.to_target.clear();
  for (const Target& target : targets) {
    if (target.blocks) {
      std::vector<CostError> points;
      for (const CurvePoint& point : curve.points)
        points.push_back({report.seconds(point.seconds), point.errors.block_relative_mse});
      curve.to_target.push_back(time_to_target(points, fit_slope(points), target.error));
      continue;
    }
    curve.to_target.push_back(time_to_target(over_time(report, curve, target.relative),
                                             target.relative ? curve.relmse_over_time : curve.mse_over_time,
                                             target.error));
  }
  find_efficiency(report, curve);
}

std::optional<Target> common_target(std::span<const Curve> curves) {
  double worst = 0;
  for (const Curve& curve : curves) {
    double best = INFINITY;
    for (const CurvePoint& point : curve.points) {
      if (point.errors.relative_mse > 0) best = std::min(best, point.errors.relative_mse);
    }
    if (std::isfinite(best)) worst = std::max(worst, best);
  }
  return worst > 0 ? std::optional(Target{true, worst}) : std::nullopt;
}

}  // namespace penumbra
