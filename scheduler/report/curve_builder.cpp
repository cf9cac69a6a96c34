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

/// The points that tell of rendering rather than of starting.
std::vector<CostError> long_enough(const std::vector<CostError>& points, double shortest) {
  std::vector<CostError> kept;
  for (const CostError& point : points) {
    if (point.cost >= shortest) kept.push_back(point);
  }
  return kept;
}

Slope slope_over_time(const std::vector<CostError>& points, double shortest) {
  const std::vector<CostError> kept = long_enough(points, shortest);
  Slope slope = slope_of(kept, "times");
  if (!slope.fit && kept.size() < points.size()) {
    slope.none_because = fmt::format("{} of {} budgets are too short to time, below {:.2g} s",
                                     points.size() - kept.size(), points.size(), shortest);
  }
  return slope;
}

/// If errors fall as 1 / T, the efficiency 1 / (error T) is constant along the curve. Otherwise it
/// characterises a budget, not a method, and is not reported.
void find_efficiency(const ReportData& report, ErrorCurve& curve) {
  curve.efficiency.reset();
  const auto& fit = curve.mse_over_time.fit;
  curve.no_efficiency = !fit ? "no slope" : fit->holds(-1) ? "" : "slope is not -1";
  if (!curve.no_efficiency.empty()) return;
  double sum = 0;
  int count = 0;
  for (const CostError& point : long_enough(over_time(report, curve, false), shortest_timed(curve))) {
    if (!(point.cost > 0 && point.error > 0)) continue;
    sum -= std::log(point.cost * point.error);
    ++count;
  }
  curve.efficiency = std::exp(sum / count);
}

/// The standard error of the mean over the images; NaN for fewer than two.
double standard_error(const std::vector<ImageResult>& images, double ImageErrors::*metric) {
  const double n = double(images.size());
  if (n < 2) return std::nan("");
  double mean = 0, squares = 0;
  for (const ImageResult& image : images) mean += image.errors.*metric / n;
  for (const ImageResult& image : images) {
    const double difference = image.errors.*metric - mean;
    squares += difference * difference;
  }
  return std::sqrt(squares / (n - 1) / n);
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
  point.mse_error = standard_error(point.images, &ImageErrors::mse);
  point.relative_mse_error = standard_error(point.images, &ImageErrors::relative_mse);
  point.squared = seeds.squared();
  point.relative = seeds.relative(epsilon);
  return point;
}

std::vector<CostError> over_time(const ReportData& report, const ErrorCurve& curve, bool relative) {
  std::vector<CostError> points;
  for (const CurvePoint& point : curve.points) {
    points.push_back(
        {report.seconds(point.seconds), relative ? point.errors.relative_mse : point.errors.mse});
  }
  return points;
}

std::vector<CostError> over_spp(const ErrorCurve& curve, bool relative) {
  std::vector<CostError> points;
  for (const CurvePoint& point : curve.points) {
    if (point.spp > 0)
      points.push_back({double(point.spp), relative ? point.errors.relative_mse : point.errors.mse});
  }
  return points;
}

double error_at_time(const ReportData& report, const ErrorCurve& curve, double seconds) {
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

double shortest_timed(const ErrorCurve& curve) {
  std::vector<double> start, workers;
  for (const CurvePoint& point : curve.points)
    for (const ImageResult& image : point.images) {
      start.push_back(image.seconds.build + image.seconds.transfer);
      workers.push_back(image.seconds.transfer);
    }
  if (curve.name.peer) return 0;
  return std::max(median(std::move(start)), kStartsOfWorkers * median(std::move(workers)));
}

void finish_curve(const ReportData& report, std::span<const Target> targets, ErrorCurve& curve) {
  const double shortest = shortest_timed(curve);
  curve.mse_over_time = slope_over_time(over_time(report, curve, false), shortest);
  curve.relmse_over_time = slope_over_time(over_time(report, curve, true), shortest);
  curve.mse_over_spp = slope_of(over_spp(curve, false), "samples");
  curve.relmse_over_spp = slope_of(over_spp(curve, true), "samples");
  curve.to_target.clear();
  for (const Target& target : targets) {
    std::vector<CostError> points;
    for (const CurvePoint& point : curve.points) {
      points.push_back({report.seconds(point.seconds), target.blocks     ? point.errors.block_relative_mse
                                                       : target.relative ? point.errors.relative_mse
                                                                         : point.errors.mse});
    }
    curve.to_target.push_back(time_to_target(points, target.error));
  }
  find_efficiency(report, curve);
}

std::optional<Target> common_target(const ReportData& report, std::span<const ErrorCurve> curves) {
  double worst = 0;
  for (const ErrorCurve& curve : curves) {
    CostError last;
    for (const CostError& point : over_time(report, curve, true)) {
      if (point.error > 0 && point.cost >= last.cost) last = point;
    }
    worst = std::max(worst, last.error);
  }
  return worst > 0 ? std::optional(Target{true, worst}) : std::nullopt;
}

}  // namespace penumbra
