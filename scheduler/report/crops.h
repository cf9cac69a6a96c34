// Pictures of all methods at the same time budget.
#pragma once

#include <optional>

#include "scheduler/report/crop_choice.h"
#include "scheduler/report/reference.h"
#include "scheduler/report/report_data.h"

namespace penumbra {

struct CropOptions {
  CropChoice choice;
  std::optional<double> seconds;  ///< nothing: the longest time that every curve comes to
  double exposure = 0;            ///< stops
};

/// The point whose time is nearest, as a ratio; null for a curve without points.
const CurvePoint* nearest_point(const ReportData& report, const Curve& curve, double seconds);

/// `errors` has the relative squared error of each pixel, summed over what was measured; see choose_crop.
/// Errors: an image that cannot be read any more.
Expected<CropSet> make_crops(const ReportData& report, const SceneReport& scene, const Reference& reference,
                             const std::vector<double>& errors, const CropOptions& options);

/// The pixels of `window`, R, G, B times 2^exposure.
Image cut(const Image& image, const PixelWindow& window, double exposure);

}  // namespace penumbra
