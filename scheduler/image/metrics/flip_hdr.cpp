// HDR-FLIP: LDR-FLIP over several exposures.
#include <algorithm>
#include <cmath>

#include "scheduler/image/metrics/color_space.h"
#include "scheduler/image/metrics/flip_core.h"

namespace penumbra {
namespace {

// (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5): Narkowicz' coefficients with x scaled by 0.6.
constexpr double kScale = 0.6;
constexpr double k0 = 2.51 * kScale * kScale, k1 = 0.03 * kScale;
constexpr double k3 = 2.43 * kScale * kScale, k4 = 0.59 * kScale, k5 = 0.14;

constexpr double kBright = 0.85;  // display value to which the brightest and the median pixel are mapped

/// The x that the tone map maps to t: the positive root of (k0 - t k3) x^2 + (k1 - t k4) x - t k5 = 0.
double inverse_tone_map(double t) {
  const double a = k0 - t * k3, b = k1 - t * k4, c = -t * k5;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*std::max_element(values.begin(), middle) + *middle);
}

}  // namespace

double aces_tone_map(double x) {
  return std::clamp((k0 * x * x + k1 * x) / (k3 * x * x + k4 * x + k5), 0.0, 1.0);
}

FlipExposures flip_exposures(const ImagePair& pair) {
  const std::size_t channels = pair.channels.size();
  std::vector<double> luminances;
  for (std::size_t pixel = 0; pixel < pair.pixels(); ++pixel) {
    if (!pair.finite[pixel]) continue;
    Color rgb{};
    for (std::size_t c = 0; c < 3; ++c)
      rgb[c] = std::max(0.0, pair.truth(pixel * channels + (channels == 3 ? c : 0)));
    luminances.push_back(luminance(rgb));
  }
  double median = median_of(luminances);
  const double largest = std::ranges::max(luminances);
  if (largest == 0) return {};
  if (median == 0) {
    std::erase(luminances, 0.0);
    median = median_of(luminances);
  }
  const double bright = inverse_tone_map(kBright);
  FlipExposures exposures{.start = std::log2(bright / largest), .stop = std::log2(bright / median)};
  exposures.count = std::max(2, int(std::ceil(exposures.stop - exposures.start)));
  return exposures;
}

Expected<FlipResult> flip_of_radiance(const ImagePair& pair, double pixels_per_degree) {
  if (const auto usable = check_flip_input(pair, pixels_per_degree); !usable) {
    return std::unexpected(usable.error());
  }
  const FlipExposures exposures = flip_exposures(pair);
  Plane largest(pair.window.width, pair.window.height);
  for (int i = 0; i < exposures.count; ++i) {
    const double stops =
        exposures.start +
        (exposures.count > 1 ? (exposures.stop - exposures.start) * i / (exposures.count - 1) : 0);
    const double factor = std::exp2(stops);
    const auto light = [&](double radiance) { return aces_tone_map(std::max(0.0, radiance) * factor); };
    const LinearPlanes reference = planes_of(pair, [&](std::size_t v) { return light(pair.truth(v)); });
    const LinearPlanes image = planes_of(pair, [&](std::size_t v) { return light(pair.value(v)); });
    const Plane error = flip_of_linear_light(reference, image, pixels_per_degree);
    for (std::size_t pixel = 0; pixel < error.values.size(); ++pixel)
      largest.values[pixel] = std::max(largest.values[pixel], error.values[pixel]);
    if (exposures.start == exposures.stop) break;  // all exposures are equal
  }
  FlipResult result = flip_summary(pair, std::move(largest), pixels_per_degree);
  result.hdr = true;
  result.exposures = exposures;
  return result;
}

}  // namespace penumbra
