#include "scheduler/denoise/guide.h"

#include <algorithm>
#include <utility>

#include "scheduler/denoise/outliers.h"

namespace penumbra {

Planes make_guide(const Planes& values, const Planes& variances, float variance_scale, const Planes& valid) {
  // Products of three of them stay far below the largest float.
  constexpr float kMostVariance = 1e10f;
  Planes guide(values.width, values.height, GUIDE_PLANES);
  for (int c = 0; c < GUIDE_CHANNELS; ++c) {
    std::ranges::copy(values.plane(c % values.count), guide.plane(c).begin());
    std::ranges::transform(variances.plane(c % variances.count), guide.plane(GUIDE_CHANNELS + c).begin(),
                           [&](float v) { return std::min(v * variance_scale, kMostVariance); });
  }
  std::ranges::copy(valid.plane(0), guide.plane(VALID_PLANE).begin());
  return guide;
}

Expected<Planes> filter(DenoiseDevice& device, const Planes& guide, const Planes& sources,
                        const NlMeansOptions& options) {
  Planes out(sources.width, sources.height, sources.count);
  const DenoiseTask task{.stage = DENOISE_FILTER,
                         .width = sources.width,
                         .height = sources.height,
                         .first_row = 0,
                         .end_row = sources.height,
                         .model_row = 0,
                         .model_rows = 0,
                         .out_row = 0,
                         .out_rows = sources.height,
                         .search_radius = options.search_radius,
                         .patch_radius = options.patch_radius,
                         .sources = sources.count,
                         .strength = options.strength};
  if (auto done = device.run(task, guide.values, sources.values, {}, out.values); !done)
    return std::unexpected(done.error());
  return out;
}

Expected<Planes> self_filtered(const DenoiseInput& input, const ColorFilter& filter) {
  return filter(make_guide(input.color, input.variance, 1, input.valid), input.color);
}

Expected<std::array<Planes, 2>> cross_filtered(const DenoiseInput& input, const ColorFilter& filter) {
  // A half has twice the variance of the mean of both.
  auto a = filter(make_guide(input.half_b, input.variance, 2, input.valid), input.half_a);
  if (!a) return std::unexpected(a.error());
  auto b = filter(make_guide(input.half_a, input.variance, 2, input.valid), input.half_b);
  if (!b) return std::unexpected(b.error());
  return std::array{std::move(*a), std::move(*b)};
}

DenoisedImage joined(const Planes& a, const Planes& b) {
  return {.color = mean_of(a, b), .residual_variance = quarter_of_squared_difference(a, b)};
}

Expected<DenoisedImage> nl_means(DenoiseDevice& device, DenoiseInput noisy, const NlMeansOptions& options) {
  const DenoiseInput input = without_outliers(std::move(noisy));
  const ColorFilter by_weights = [&](const Planes& guide, const Planes& color) {
    return filter(device, guide, color, options);
  };
  if (!input.has_halves()) {
    auto color = self_filtered(input, by_weights);
    if (!color) return std::unexpected(color.error());
    return DenoisedImage{.color = std::move(*color), .residual_variance = {}};
  }
  const auto halves = cross_filtered(input, by_weights);
  if (!halves) return std::unexpected(halves.error());
  return joined((*halves)[0], (*halves)[1]);
}

Planes some_planes(const Planes& image, int first, int count) {
  Planes some(image.width, image.height, count);
  for (int k = 0; k < count; ++k) std::ranges::copy(image.plane(first + k), some.plane(k).begin());
  return some;
}

namespace {

template <typename Function>
Planes combined(const Planes& a, const Planes& b, Function function) {
  Planes result(a.width, a.height, a.count);
  std::ranges::transform(a.values, b.values, result.values.begin(), function);
  return result;
}

}  // namespace

Planes mean_of(const Planes& a, const Planes& b) {
  return combined(a, b, [](float x, float y) { return 0.5f * x + 0.5f * y; });
}

Planes quarter_of_squared_difference(const Planes& a, const Planes& b) {
  return combined(a, b, [](float x, float y) { return 0.25f * (x - y) * (x - y); });
}

Planes box_mean(const Planes& image, int radius) {
  // Rows, then columns. Each mean is a sum of its own, so that it does not depend on the others.
  Planes rows(image.width, image.height, image.count), result = rows;
  const auto mean = [&](std::span<const float> from, int at, int size, std::ptrdiff_t step) {
    const int begin = std::max(0, at - radius), end = std::min(size, at + radius + 1);
    float sum = 0;
    for (int i = begin; i < end; ++i) sum += from[std::size_t(std::ptrdiff_t(i) * step)];
    return sum / float(end - begin);
  };
  const auto width = std::size_t(image.width);
  for (int k = 0; k < image.count; ++k) {
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        rows.plane(k)[std::size_t(y) * width + std::size_t(x)] =
            mean(image.plane(k).subspan(std::size_t(y) * width, width), x, image.width, 1);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        result.plane(k)[std::size_t(y) * width + std::size_t(x)] =
            mean(rows.plane(k).subspan(std::size_t(x)), y, image.height, image.width);
  }
  return result;
}

}  // namespace penumbra
