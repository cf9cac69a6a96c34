#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string_view>

#include "kernels/denoise/denoise_task.h"
#include "scenes/names.h"
#include "scheduler/denoise/denoise_image.h"
#include "scheduler/denoise/guide.h"
#include "scheduler/denoise/layers.h"

namespace penumbra {
namespace {

// Beyond any use; their squares, and sums of those, do not overflow.
constexpr float kMostRadiance = 1e15f, kMostNoise = 1e30f, kMostFeature = 1e3f;

/// A channel of the image that becomes a plane, limited to ±`most`.
struct PlaneSource {
  std::size_t channel;
  float scale, most;
  std::span<float> plane;
  bool decides;  ///< a value that is not finite makes the pixel invalid
};

/// Copies all planes in one pass over the image. Values that are not finite become 0.
void copy_planes(const Image& image, const std::vector<PlaneSource>& sources, std::span<float> valid) {
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float* pixel = image.values.data() + i * image.channels.size();
    for (const PlaneSource& source : sources) {
      const float value = pixel[source.channel] * source.scale;
      const bool is_finite = std::isfinite(value);
      source.plane[i] = is_finite ? std::clamp(value, -source.most, source.most) : 0;
      if (source.decides && !is_finite) valid[i] = 0;
    }
  }
}

/// The median of positive values; 0 if there are none.
float median(std::vector<float> values) {
  std::erase_if(values, [](float value) { return !(value > 0); });
  if (values.empty()) return 0;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// A power of two, so that the result does not depend on the exposure: the inverse of the median brightness.
float brightness_scale(const Image& image, std::span<const std::size_t> channels) {
  std::vector<float> brightness;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    float sum = 0;
    for (const std::size_t k : channels) sum += image.values[i * image.channels.size() + k] / 3;
    if (std::isfinite(sum)) brightness.push_back(sum);
  }
  const float middle = median(std::move(brightness));
  return middle > 0 ? std::ldexp(1.0f, -std::clamp(std::ilogb(middle), -100, 100)) : 1;
}

/// The variance of noise in an image of which nothing else is known: the mean square, over 7 x 7 pixels, of a
/// second difference that is 0 for linear functions. J. Immerkaer, "Fast Noise Variance Estimation" (1996).
Planes variance_from_neighbours(const Planes& color) {
  Planes squares(color.width, color.height, color.count);
  for (int k = 0; k < color.count; ++k)
    for (int y = 0; y < color.height; ++y)
      for (int x = 0; x < color.width; ++x) {
        float difference = 0;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const int at_x = std::clamp(x + dx, 0, color.width - 1),
                      at_y = std::clamp(y + dy, 0, color.height - 1);
            const float weight = float((dx == 0 ? 2 : -1) * (dy == 0 ? 2 : -1));
            difference +=
                weight * color.plane(k)[std::size_t(at_y) * std::size_t(color.width) + std::size_t(at_x)];
          }
        squares.plane(k)[std::size_t(y) * std::size_t(color.width) + std::size_t(x)] =
            difference * difference / 36;  // the sum of the squared weights
      }
  return box_mean(squares, 3);
}

/// Divides depths by twice their median, and limits them to twice that: a background far away must not make
/// all other differences small.
void scale_depth(Planes& features, Planes& variances) {
  const std::span<float> depth = features.plane(6), variance = variances.plane(6);
  const float unit = 2 * median({depth.begin(), depth.end()});
  if (!(unit > 0)) return;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    variance[i] = depth[i] > 2 * unit ? 0 : variance[i] / (unit * unit);
    depth[i] = std::min(depth[i] / unit, 2.0f);
  }
}

}  // namespace

Expected<ScaledInput> denoise_input(const Image& noisy, std::vector<std::string>* remarks) {
  const auto say = [&](std::string text) {
    if (remarks != nullptr) remarks->push_back(std::move(text));
  };
  const auto beauty = noisy.beauty_channels();
  std::vector<std::size_t> rgb;
  if (beauty)
    rgb.assign(beauty->begin(), beauty->end());
  else
    rgb = find_layer(noisy, {"combined"}, {"RGB"});
  if (rgb.empty()) return fail("it has no channels R, G, B");
  if (noisy.pixels() == 0) return fail("it has no pixels");

  const int width = noisy.data.width, height = noisy.data.height;
  ScaledInput result;
  result.scale = brightness_scale(noisy, rgb);
  std::ranges::copy(rgb, result.channels.begin());
  DenoiseInput& input = result.input;
  input.valid = Planes(width, height, 1, 1.0f);
  input.color = Planes(width, height, 3);
  std::vector<PlaneSource> sources;
  const auto copy = [&](std::span<const std::size_t> channels, float scale, float most, Planes& to,
                        int first_plane, bool decides) {
    for (std::size_t k = 0; k < channels.size(); ++k)
      sources.push_back({channels[k], scale, most, to.plane(first_plane + int(k)), decides});
  };
  copy(rgb, result.scale, kMostRadiance, input.color, 0, true);

  const auto half_a = find_layer(noisy, {"half_a"}, {"RGB"}), half_b = find_layer(noisy, {"half_b"}, {"RGB"});
  if (!half_a.empty() && !half_b.empty()) {
    input.half_a = input.half_b = Planes(width, height, 3);
    copy(half_a, result.scale, kMostRadiance, input.half_a, 0, true);
    copy(half_b, result.scale, kMostRadiance, input.half_b, 0, true);
  } else {
    say("it has no halves of the samples (half_a, half_b), which `penumbra render --denoise=layers` writes: "
        "it is "
        "filtered by its own noise, and there is no error estimate");
  }
  const auto variance = find_layer(noisy, {"variance"}, {"RGB"});
  if (!variance.empty()) {
    input.variance = Planes(width, height, 3);
    copy(variance, result.scale * result.scale, kMostNoise, input.variance, 0, true);
  }

  input.features = input.feature_variance = Planes(width, height, REGRESSION_FEATURES);
  struct Feature {
    const char* name;
    std::vector<std::size_t> channels, variances;
    int plane;
    float most;
  };
  const Feature features[] = {
      {"albedo", find_layer(noisy, {"albedo", "denoising albedo"}, {"RGB"}),
       find_layer(noisy, {"albedo_variance"}, {"RGB"}), 0, kMostFeature},
      {"normal", find_layer(noisy, {"normal", "denoising normal", "sh_normal", "ns", "n"}, {"XYZ", "RGB"}),
       find_layer(noisy, {"normal_variance"}, {"XYZ"}), 3, kMostFeature},
      {"depth", find_layer(noisy, {"depth", "denoising depth"}, {"Z", "V", "Y", "T"}),
       find_layer(noisy, {"depth_variance"}, {"Z"}), 6, kMostRadiance}};
  std::vector<std::string_view> missing, unknown;
  for (const Feature& feature : features) {
    if (feature.channels.empty()) {
      missing.emplace_back(feature.name);
      continue;
    }
    copy(feature.channels, 1, feature.most, input.features, feature.plane, false);
    copy(feature.variances, 1, feature.most * feature.most, input.feature_variance, feature.plane, false);
    if (feature.variances.empty()) unknown.emplace_back(feature.name);
  }
  copy_planes(noisy, sources, input.valid.plane(0));
  for (float& v : input.feature_variance.values) v = std::max(v, 0.0f);
  for (float& v : input.variance.values) v = std::max(v, 0.0f);
  scale_depth(input.features, input.feature_variance);
  if (variance.empty() && input.has_halves()) {
    input.variance = box_mean(quarter_of_squared_difference(input.half_a, input.half_b), 3);
    say("it has no variance: that of its halves is used");
  } else if (variance.empty()) {
    input.variance = variance_from_neighbours(input.color);
    say("it has no variance (variance.R, .G, .B): noise is estimated from neighbouring pixels");
  }
  if (!missing.empty()) say(fmt::format("layers that it lacks: {}", fmt::join(missing, ", ")));
  if (!unknown.empty())
    say(fmt::format("layers without variance, taken as free of noise: {}", fmt::join(unknown, ", ")));
  return result;
}

}  // namespace penumbra
