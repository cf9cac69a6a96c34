// From images to curves: errors of each budget, slopes, times to targets, efficiency.
#pragma once

#include <functional>
#include <vector>

#include "scheduler/report/reference.h"
#include "scheduler/report/report_data.h"

namespace penumbra {

/// Middle of the values, mean of the two middle ones; 0 for none.
double median(std::vector<double> values);

ImageErrors measure_errors(const ImagePair& pair, double epsilon);

/// One budget: reads the images of `images`, measures each, and all of them together. `on_pair` (which may be
/// empty) sees each pair. Errors: an image that cannot be read or does not fit the reference.
Expected<CurvePoint> measure_point(std::uint32_t spp, std::vector<ImageResult> images,
                                   const Reference& reference, double epsilon,
                                   const std::function<void(const ImagePair&)>& on_pair = {});

/// MSE or relMSE of each point over its median seconds, or over samples per pixel.
std::vector<CostError> over_time(const ReportData& report, const Curve& curve, bool relative);
std::vector<CostError> over_spp(const Curve& curve, bool relative);

/// relMSE at that time, linear in log error over log time between budgets; NaN outside of them.
double error_at_time(const ReportData& report, const Curve& curve, double seconds);

/// Fits the curve's points, and finds the times to `targets` and the efficiency.
void finish_curve(const ReportData& report, std::span<const Target> targets, Curve& curve);

/// The smallest relMSE that every curve reaches: a target for all of them. Nothing where there is none.
std::optional<Target> common_target(std::span<const Curve> curves);

}  // namespace penumbra
