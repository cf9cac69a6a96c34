#include <algorithm>
#include <utility>
#include <vector>

#include "kernels/denoise/denoise_task.h"
#include "scheduler/denoise/guide.h"
#include "scheduler/denoise/outliers.h"

namespace penumbra {
namespace {

constexpr NlMeansOptions kFeatureFilter{.search_radius = 5, .patch_radius = 3, .strength = 0.5f};
constexpr NlMeansOptions kErrorFilter{.search_radius = 5, .patch_radius = 1, .strength = 1.0f};
constexpr int kRegressionRadius = 6, kRegressionPatch = 3;
// Models take much memory, so an image is processed in bands. Their models fill whole tiles.
constexpr int kBandRows = 8 * DENOISE_TILE_HEIGHT - 2 * kRegressionRadius;

/// Albedo, normal and depth, each filtered with its own weights.
Expected<Planes> filtered_features(DenoiseDevice& device, const DenoiseInput& input) {
  Planes features = input.features;
  for (const auto& [first, count] : {std::pair(0, 3), std::pair(3, 3), std::pair(6, 1)}) {
    const Planes noisy = some_planes(input.features, first, count);
    const Planes guide = make_guide(noisy, some_planes(input.feature_variance, first, count), 1, input.valid);
    const auto smooth = filter(device, guide, noisy, kFeatureFilter);
    if (!smooth) return smooth;
    for (int k = 0; k < count; ++k) std::ranges::copy(smooth->plane(k), features.plane(first + k).begin());
  }
  return features;
}

/// The colours at both bandwidths: 6 planes. Weights are those of `guide`; `colors` are regressed on
/// `features`.
Expected<Planes> regress(DenoiseDevice& device, const Planes& guide, const Planes& features,
                         const Planes& colors) {
  const int width = colors.width, height = colors.height;
  Planes sources(width, height, REGRESSION_FEATURES + REGRESSION_COLORS);
  std::ranges::copy(features.values, sources.values.begin());
  std::ranges::copy(colors.values, sources.plane(REGRESSION_FEATURES).begin());
  Planes out(width, height, REGRESSION_BANDWIDTHS * REGRESSION_COLORS);
  std::vector<float> models;
  for (int row = 0; row < height; row += kBandRows) {
    const int end = std::min(row + kBandRows, height);
    DenoiseTask task{.stage = DENOISE_FIT,
                     .width = width,
                     .height = height,
                     .first_row = std::max(0, row - kRegressionRadius),
                     .end_row = std::min(height, end + kRegressionRadius),
                     .model_row = std::max(0, row - kRegressionRadius),
                     .model_rows = 0,
                     .out_row = row,
                     .out_rows = end - row,
                     .search_radius = kRegressionRadius,
                     .patch_radius = kRegressionPatch,
                     .sources = 0,
                     .strength = 1};
    task.model_rows = task.end_row - task.first_row;
    models.resize(std::size_t(denoise_tiles_of(&task)) * MODEL_PLANES * DENOISE_TILE_PIXELS);
    if (auto done = device.run(task, guide.values, sources.values, models, {}); !done)
      return std::unexpected(done.error());
    task.stage = DENOISE_PREDICT;
    task.first_row = row;
    task.end_row = end;
    Planes band(width, end - row, out.count);
    if (auto done = device.run(task, guide.values, sources.values, models, band.values); !done)
      return std::unexpected(done.error());
    for (int k = 0; k < out.count; ++k)
      std::ranges::copy(band.plane(k), out.plane(k).begin() + std::ptrdiff_t(row) * width);
  }
  return out;
}

/// The squared error of a denoised half, as the noisy half that its weights come from shows it: unbiased, but
/// noisy. Adds its mean over channels, for each bandwidth.
void add_error(const Planes& denoised, const Planes& noisy, const Planes& variance, Planes& error) {
  for (int b = 0; b < REGRESSION_BANDWIDTHS; ++b)
    for (int c = 0; c < REGRESSION_COLORS; ++c)
      for (std::size_t i = 0; i < error.pixels(); ++i) {
        const float difference = denoised.plane(b * REGRESSION_COLORS + c)[i] - noisy.plane(c)[i];
        error.plane(b)[i] += (difference * difference - 2 * variance.plane(c)[i]) / (2 * REGRESSION_COLORS);
      }
}

/// The weight of the whole bandwidth against half of it, from 0 to 1: where it has the smaller error,
/// smoothed. `a` and `b` are the halves at both bandwidths.
Expected<Planes> bandwidth_weights(DenoiseDevice& device, const DenoiseInput& input, const Planes& a,
                                   const Planes& b) {
  Planes error(input.color.width, input.color.height, REGRESSION_BANDWIDTHS);
  add_error(a, input.half_b, input.variance, error);
  add_error(b, input.half_a, input.variance, error);
  const Planes guide = make_guide(input.color, input.variance, 1, input.valid);
  const auto smooth_error = filter(device, guide, error, kErrorFilter);
  if (!smooth_error) return smooth_error;
  Planes choice(input.color.width, input.color.height, 1);
  for (std::size_t i = 0; i < choice.pixels(); ++i)
    choice.values[i] = smooth_error->plane(1)[i] < smooth_error->plane(0)[i] ? 1 : 0;
  return filter(device, guide, choice, kErrorFilter);
}

/// The colours at the chosen bandwidths.
Planes mix_bandwidths(const Planes& of_both, const Planes& weights) {
  Planes mix(of_both.width, of_both.height, REGRESSION_COLORS);
  for (int c = 0; c < REGRESSION_COLORS; ++c)
    for (std::size_t i = 0; i < mix.pixels(); ++i) {
      const float w = weights.values[i];
      mix.plane(c)[i] = (1 - w) * of_both.plane(c)[i] + w * of_both.plane(REGRESSION_COLORS + c)[i];
    }
  return mix;
}

}  // namespace

Expected<DenoisedImage> nfor(DenoiseDevice& device, DenoiseInput noisy) {
  const DenoiseInput input = without_outliers(std::move(noisy));
  const auto features = filtered_features(device, input);
  if (!features) return std::unexpected(features.error());
  const ColorFilter by_features = [&](const Planes& guide, const Planes& color) {
    return regress(device, guide, *features, color);
  };
  if (!input.has_halves()) {
    const auto color = self_filtered(input, by_features);
    if (!color) return std::unexpected(color.error());
    return DenoisedImage{.color = some_planes(*color, 0, REGRESSION_COLORS), .residual_variance = {}};
  }
  const auto halves = cross_filtered(input, by_features);
  if (!halves) return std::unexpected(halves.error());
  const auto& [a, b] = *halves;
  const auto weights = bandwidth_weights(device, input, a, b);
  if (!weights) return std::unexpected(weights.error());
  return joined(mix_bandwidths(a, *weights), mix_bandwidths(b, *weights));
}

}  // namespace penumbra
