// Crops of the images of all methods at equal time.
#pragma once

#include <optional>

#include "scheduler/report/crop_choice.h"
#include "scheduler/report/reference.h"
#include "scheduler/report/report_data.h"

namespace penumbra {

struct CropOptions {
  CropChoice choice;
  std::optional<double> seconds;  ///< nothing: the longest time that all curves reach
  double exposure = 0;            ///< stops
};

/// The point with the nearest time, by ratio; null for a curve without points.
const CurvePoint* nearest_point(const ReportData& report, const ErrorCurve& curve, double seconds);

/// `errors` holds the relative squared error of each pixel, summed over all measurements; see choose_crop.
/// Errors: an image cannot be read any more.
Expected<CropSet> make_crops(const ReportData& report, const SceneReport& scene, const Reference& reference,
                             const std::vector<double>& errors, const CropOptions& options);

/// R, G, B of the pixels in `window`, times 2^exposure.
Image cut(const Image& image, const PixelWindow& window, double exposure);

}  // namespace penumbra
