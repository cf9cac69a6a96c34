#include "scheduler/report/crops.h"

#include <algorithm>
#include <cmath>

#include "scheduler/image/image_files.h"
#include "scheduler/image/metrics/error_map.h"
#include "scheduler/image/metrics/flip.h"
#include "scheduler/report/cell_store.h"

namespace penumbra {
namespace {

double common_seconds(const ReportData& report, const SceneReport& scene) {
  double common = INFINITY;
  for (const ErrorCurve& curve : scene.curves) {
    double longest = 0;
    for (const CurvePoint& point : curve.points) longest = std::max(longest, report.seconds(point.seconds));
    if (longest > 0) common = std::min(common, longest);
  }
  return std::isfinite(common) ? common : 0;
}

/// The mean of both halves of a reference.
Image mean_of(const Reference& reference) {
  Image mean = beauty_only(reference.first);
  if (!reference.second) return mean;
  const Image second = beauty_only(*reference.second);
  for (std::size_t i = 0; i < mean.values.size() && i < second.values.size(); ++i)
    mean.values[i] = 0.5f * (mean.values[i] + second.values[i]);
  return mean;
}

struct Measured {
  CropPicture picture;
  ErrorMap map;
};

Expected<Measured> measure(const CurvePoint& point, const Reference& reference, const PixelWindow& window,
                           const ReportData& report, double exposure) {
  Measured measured;
  const ImageResult& result = point.images.front();
  const auto image = read_image(result.file);
  if (!image) return std::unexpected(image.error());
  const auto whole = reference.pair(*image);
  if (!whole) return std::unexpected(whole.error());
  Reference part{cut(reference.first, window, 0), std::nullopt};
  if (reference.second) part.second = cut(*reference.second, window, 0);
  const auto pair = part.pair(cut(*image, window, 0));
  if (!pair) return std::unexpected(pair.error());
  CropPicture& picture = measured.picture;
  picture.spp = point.spp;
  picture.seconds = report.seconds(result.seconds);
  picture.relmse = relative_mse(*pair, report.epsilon).overall;
  picture.mse = mean_squared_error(*pair).overall;
  picture.image_relmse = result.errors.relative_mse;
  if (const auto flip = flip_of_radiance(*whole)) picture.flip = flip->mean;
  auto png = encode_png(cut(*image, window, exposure));
  if (!png) return std::unexpected(png.error());
  picture.png = std::move(*png);
  auto whole_png = encode_png(cut(*image, reference.window(), exposure));
  if (!whole_png) return std::unexpected(whole_png.error());
  picture.whole_png = std::move(*whole_png);
  measured.map = relative_error_map(*pair, report.epsilon);
  return measured;
}

}  // namespace

Image cut(const Image& image, const PixelWindow& window, double exposure) {
  const Image beauty = beauty_only(image);
  Image part{window, image.display, beauty.channels, {}, {}};
  const float scale = float(std::exp2(exposure));
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x)
      for (std::size_t c = 0; c < beauty.channels.size(); ++c)
        part.values.push_back(scale * beauty.at(x + window.x - image.data.x, y + window.y - image.data.y, c));
  return part;
}

const CurvePoint* nearest_point(const ReportData& report, const ErrorCurve& curve, double seconds) {
  const auto distance = [&](const CurvePoint& point) {
    return std::abs(std::log(std::max(1e-9, report.seconds(point.seconds)) / std::max(1e-9, seconds)));
  };
  const auto nearest = std::ranges::min_element(curve.points, {}, distance);
  return nearest == curve.points.end() ? nullptr : &*nearest;
}

Expected<CropSet> make_crops(const ReportData& report, const SceneReport& scene, const Reference& reference,
                             const std::vector<double>& errors, const CropOptions& options) {
  CropSet set;
  const ChosenCrop chosen = choose_crop(options.choice, reference.window(), errors);
  const PixelWindow& window = chosen.window;
  set.x = window.x;
  set.y = window.y;
  set.width = window.width;
  set.height = window.height;
  set.why_here = chosen.why;
  set.exposure = options.exposure;
  set.seconds = options.seconds.value_or(common_seconds(report, scene));
  const PixelWindow all = reference.window();
  set.film_x = all.x;
  set.film_y = all.y;
  set.overview_width = all.width;
  set.overview_height = all.height;
  const Image truth = mean_of(reference);
  auto overview = encode_png(cut(truth, all, options.exposure));
  auto reference_png = encode_png(cut(truth, window, options.exposure));
  if (!overview) return std::unexpected(overview.error());
  if (!reference_png) return std::unexpected(reference_png.error());
  set.overview_png = std::move(*overview);
  set.reference_png = std::move(*reference_png);

  std::vector<Measured> measured;
  std::vector<double> tops;
  for (const ErrorCurve& curve : scene.curves) {
    const CurvePoint* point = nearest_point(report, curve, set.seconds);
    if (point == nullptr) continue;
    auto one = measure(*point, reference, window, report, options.exposure);
    if (!one) return std::unexpected(one.error());
    one->picture.label = curve.name.label;
    tops.push_back(default_range(one->map).high);
    measured.push_back(std::move(*one));
  }
  // One scale for all maps, so that they can be compared.
  const double top = tops.empty() ? 1 : *std::ranges::max_element(tops);
  const MapRange range =
      MapRange{0, std::pow(10.0, std::ceil(std::log10(top > 0 ? top : 1)))}.on_logarithmic_scale();
  set.heat_low = range.low;
  set.heat_high = range.high;
  for (Measured& one : measured) {
    auto heat = encode_png(heat_map_image(one.map, range));
    if (!heat) return std::unexpected(heat.error());
    one.picture.heat_png = std::move(*heat);
    set.pictures.push_back(std::move(one.picture));
  }
  return set;
}

}  // namespace penumbra
