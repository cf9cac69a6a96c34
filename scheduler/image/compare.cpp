#include "scheduler/image/compare.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "kernels/host/text.h"
#include "scenes/number.h"
#include "scheduler/image/picture.h"

namespace penumbra {
namespace {

double largest_magnitude(const ChannelValues& values) {
  double largest = 0;
  for (const double value : values.channels) {
    if (std::isnan(value)) return value;
    largest = std::max(largest, std::abs(value));
  }
  return largest;
}

struct Metric {
  const char* name;
  enum { kAlways, kFlip, kZTest } needs;
  double (*value)(const Comparison&);
};

constexpr Metric kMetrics[] = {
    {"relmse", Metric::kAlways, [](const Comparison& c) { return c.relative_mse.overall; }},
    {"trimmed_relmse", Metric::kAlways, [](const Comparison& c) { return c.trimmed_relative_mse.overall; }},
    {"block_relmse", Metric::kAlways, [](const Comparison& c) { return c.block_relative_mse.overall; }},
    {"mse", Metric::kAlways, [](const Comparison& c) { return c.mse.overall; }},
    {"mape", Metric::kAlways, [](const Comparison& c) { return c.mape.overall; }},
    {"smape", Metric::kAlways, [](const Comparison& c) { return c.smape.overall; }},
    {"bias", Metric::kAlways, [](const Comparison& c) { return largest_magnitude(c.bias); }},
    {"relative_bias", Metric::kAlways,
     [](const Comparison& c) { return largest_magnitude(c.relative_bias); }},
    {"max", Metric::kAlways, [](const Comparison& c) { return c.largest.overall; }},
    {"flip", Metric::kFlip, [](const Comparison& c) { return c.flip->mean; }},
    {"max_flip", Metric::kFlip, [](const Comparison& c) { return c.flip->largest; }},
    {"max_z", Metric::kZTest, [](const Comparison& c) { return std::abs(c.z_test->largest.z); }},
    {"block_z", Metric::kZTest, [](const Comparison& c) { return std::abs(c.z_test->block_mean.z); }},
    {"mean_z", Metric::kZTest, [](const Comparison& c) { return std::abs(c.z_test->image_mean.z); }},
    {"z_above_1.96", Metric::kZTest, [](const Comparison& c) { return c.z_test->share_above_1_96; }},
    {"z_above_2.58", Metric::kZTest, [](const Comparison& c) { return c.z_test->share_above_2_58; }}};

bool is_beauty(const std::string& layer) { return layer.empty() || layer == "beauty"; }

/// The kind of FLIP that kAuto selects for these images; if none, also the reason.
std::pair<FlipKind, std::string> chosen_flip(const CompareImages& images, const CompareOptions& options) {
  if (options.flip == FlipKind::kNone) return {FlipKind::kNone, "not asked for"};
  if (options.flip != FlipKind::kAuto) return {options.flip, ""};
  if (!is_beauty(options.layer)) return {FlipKind::kNone, "only for the beauty layer"};
  return {is_display_image(images.image) ? FlipKind::kDisplay : FlipKind::kRadiance, ""};
}

Expected<void> add_flip(const CompareImages& images, const CompareOptions& options, Comparison& result) {
  const auto [kind, why_not] = chosen_flip(images, options);
  result.flip_left_out = why_not;
  if (kind == FlipKind::kNone) return {};
  auto flip = kind == FlipKind::kDisplay ? flip_of_display_images(result.pair, options.pixels_per_degree)
                                         : flip_of_radiance(result.pair, options.pixels_per_degree);
  if (!flip) return std::unexpected(flip.error());
  result.flip = std::move(*flip);
  return {};
}

/// The variance from a separate file, else from the image's layer, else empty. Errors: the separate file does
/// not match.
Expected<std::vector<float>> variance_of(const Image& image, const Image* variance,
                                         const Comparison& result) {
  if (variance != nullptr) return variance_image(*variance, result.pair, result.layer);
  return variance_layer(image, result.pair, result.layer).value_or(std::vector<float>{});
}

/// The variance of the mean of both references; empty if only one of them has a variance.
std::vector<float> variance_of_mean(const std::vector<float>& first, const std::vector<float>& second) {
  if (first.empty() || second.empty()) return {};
  std::vector<float> mean(first.size());
  std::ranges::transform(first, second, mean.begin(), [](float a, float b) { return 0.25f * (a + b); });
  return mean;
}

/// Samples per pixel of the reference, or of the mean of both references.
std::vector<float> reference_samples(const CompareImages& images) {
  std::vector<float> samples = samples_per_pixel(images.reference);
  if (images.second_reference == nullptr) return samples;
  const std::vector<float> second = samples_per_pixel(*images.second_reference);
  if (second.size() != samples.size()) return {};
  std::ranges::transform(samples, second, samples.begin(), std::plus());
  return samples;
}

Expected<void> add_z_test(const CompareImages& images, const CompareOptions& options, Comparison& result) {
  auto of_image = variance_of(images.image, images.variance, result);
  if (!of_image) return fail("variance: " + of_image.error().message);
  auto of_reference = variance_of(images.reference, images.reference_variance, result);
  if (!of_reference) return fail("variance of the reference: " + of_reference.error().message);
  if (images.second_reference != nullptr && images.reference_variance == nullptr) {
    *of_reference = variance_of_mean(*of_reference, *variance_of(*images.second_reference, nullptr, result));
  }
  if (of_image->empty() && of_reference->empty()) {
    result.z_test_left_out =
        is_display_image(images.image) ? "8-bit images have no variances" : "neither image has a variance";
    return {};
  }
  result.image_variance = std::move(*of_image);
  result.reference_variance = std::move(*of_reference);
  // Variances in files of their own count as exact.
  if (images.variance == nullptr) result.image_samples = samples_per_pixel(images.image);
  if (images.reference_variance == nullptr) result.reference_samples = reference_samples(images);
  auto test = z_test(result.pair, result.image_noise(), result.reference_noise(), options.z_test);
  if (!test) return std::unexpected(test.error());
  result.z_test = std::move(*test);
  return {};
}

/// Fails if one of the images is linear and another one display-referred.
Expected<void> same_encoding(const CompareImages& images) {
  const bool display = is_display_image(images.image);
  for (const Image* other : {&images.reference, images.second_reference}) {
    if (other == nullptr || is_display_image(*other) == display) continue;
    return fail(
        fmt::format("{} is linear and {} is display-referred (sRGB); --ldr compares both as 8-bit sRGB",
                    display ? "the reference" : "the image", display ? "the image" : "the reference"));
  }
  return {};
}

}  // namespace

double Comparison::mean_ratio(std::size_t channel) const {
  return image_mean.channels[channel] / reference_mean.channels[channel];
}

Expected<Comparison> compare_images(const CompareImages& images, const CompareOptions& options) {
  if (const auto same = same_encoding(images); !same) return std::unexpected(same.error());
  auto pair = pair_images(images.image, images.reference, images.second_reference, options.layer);
  if (!pair) return std::unexpected(pair.error());
  Comparison result;
  result.layer = is_beauty(options.layer) ? "beauty" : options.layer;
  result.pair = std::move(*pair);
  const ImagePair& p = result.pair;
  result.epsilon = options.epsilon;
  result.trimmed_pixels = trimmed_pixels(p);
  result.image_mean = image_mean(p);
  result.reference_mean = reference_mean(p);
  result.bias = bias(p);
  result.relative_bias = relative_bias(p);
  result.mse = mean_squared_error(p);
  result.relative_mse = relative_mse(p, options.epsilon);
  result.trimmed_relative_mse = trimmed_relative_mse(p, options.epsilon);
  result.block_relative_mse = block_relative_mse(p, options.epsilon);
  result.mape = mean_absolute_percentage_error(p, options.epsilon);
  result.smape = symmetric_mean_absolute_percentage_error(p, options.epsilon);
  result.psnr = peak_signal_to_noise_ratio(p);
  result.largest = largest_differences(p);
  result.largest_at = largest_difference(p);
  if (const auto added = add_flip(images, options, result); !added) return std::unexpected(added.error());
  if (const auto added = add_z_test(images, options, result); !added) return std::unexpected(added.error());
  set_verdict(images, options, result);
  return result;
}

Expected<ErrorMap> error_map(const Comparison& c, const std::string& name) {
  if (name == "relmse") return relative_error_map(c.pair, c.epsilon);
  if (name == "abs") return absolute_error_map(c.pair);
  if (name == "flip") {
    if (!c.flip) return fail("no map of FLIP: it was left out, " + c.flip_left_out);
    return ErrorMap{"flip", c.pair.window, c.flip->pixels};
  }
  if (name == "z") {
    if (!c.z_test) return fail("no map of z: " + c.z_test_left_out);
    return z_map(c.pair, z_values(c.pair, c.image_noise(), c.reference_noise(), c.z_test->options.block));
  }
  return fail(fmt::format("there is no map '{}', but relmse, abs, flip and z", name));
}

std::vector<std::string> limit_metrics() {
  std::vector<std::string> names;
  for (const Metric& metric : kMetrics) names.emplace_back(metric.name);
  return names;
}

Expected<CompareLimit> parse_limit(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos)
    return fail(fmt::format("'{}' is not of the form METRIC=VALUE", text));
  CompareLimit limit{.metric = std::string(text.substr(0, equals))};
  if (std::ranges::none_of(kMetrics, [&](const Metric& m) { return limit.metric == m.name; })) {
    return fail(fmt::format("there is no metric '{}'{}; there are {}", limit.metric,
                            suggestion(limit.metric, limit_metrics()), fmt::join(limit_metrics(), ", ")));
  }
  const std::string_view number = text.substr(equals + 1);
  const auto value = parse_number(number);
  if (!value || *value < 0) return fail(fmt::format("'{}' is not a number from 0 up", number));
  limit.value = *value;
  return limit;
}

Expected<double> limited_value(const Comparison& comparison, std::string_view name) {
  for (const Metric& metric : kMetrics) {
    if (metric.name != name) continue;
    if (metric.needs == Metric::kFlip && !comparison.flip) {
      return fail(fmt::format("{} is not known: {}", name, comparison.flip_left_out));
    }
    if (metric.needs == Metric::kZTest && !comparison.z_test) {
      return fail(fmt::format("{} is not known: {}", name, comparison.z_test_left_out));
    }
    return metric.value(comparison);
  }
  return fail(fmt::format("there is no metric '{}'", name));
}

}  // namespace penumbra
