// Computes curves from images: errors of each budget, slopes, times to targets, efficiency.
#pragma once

#include <functional>
#include <vector>

#include "scheduler/report/reference.h"
#include "scheduler/report/report_data.h"

namespace penumbra {

/// The median: the middle value, or the mean of the two middle ones; 0 for no values.
double median(std::vector<double> values);

ImageErrors measure_errors(const ImagePair& pair, double epsilon);

/// Computes one point: reads the images, measures each and all of them together. `on_pair` (which may be
/// empty) is called with each pair. Errors: an image cannot be read or does not match the reference.
Expected<CurvePoint> measure_point(std::uint32_t spp, std::vector<ImageResult> images,
                                   const Reference& reference, double epsilon,
                                   const std::function<void(const ImagePair&)>& on_pair = {});

/// MSE or relMSE of each point over its median time, or over samples per pixel.
std::vector<CostError> over_time(const ReportData& report, const ErrorCurve& curve, bool relative);
std::vector<CostError> over_spp(const ErrorCurve& curve, bool relative);

/// relMSE at that time, interpolated linearly in log error over log time; NaN outside the measured range.
double error_at_time(const ReportData& report, const ErrorCurve& curve, double seconds);

/// Fits the curve's slopes, over time only to budgets that take at least shortest_timed, and computes the
/// times to `targets` and the efficiency.
void finish_curve(const ReportData& report, std::span<const Target> targets, ErrorCurve& curve);

/// The shortest render time, in seconds, from which slopes over time are fitted: what the start takes, from
/// the scene file to the first worker that is ready, and at least kStartsOfWorkers times what starting the
/// workers takes. Medians over all images. 0 for peers, of which both are unknown.
double shortest_timed(const ErrorCurve& curve);

/// Waking threads and first requests take about as long within a render as starting the workers before it. In
/// a run that is so many times longer they are at most a fourth.
constexpr double kStartsOfWorkers = 4;

/// The smallest relMSE that the longest run of every curve reaches, as a common target. Nothing if there is
/// none.
std::optional<Target> common_target(const ReportData& report, std::span<const ErrorCurve> curves);

}  // namespace penumbra
