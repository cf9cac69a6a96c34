#include "scheduler/image/metrics/z_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scheduler/image/metrics/compensated_sum.h"
#include "scheduler/image/metrics/distributions.h"

namespace penumbra {
namespace {

constexpr int kParts = 4;  // number of tests; see z_test.h
constexpr double kRounding = 0x1p-18;

struct Deviate {
  enum Kind { kNone, kInvalid, kExactEqual, kExactDifferent, kNoisy } kind = kNone;
  double difference = 0, variance = 0;
  [[nodiscard]] double z() const { return difference / std::sqrt(variance); }
};

struct Input {
  const ImagePair& pair;
  std::span<const float> image_variance, reference_variance;

  [[nodiscard]] Deviate at(std::size_t i) const {
    if (!pair.finite[i / pair.channels.size()]) return {};
    const double a = image_variance.empty() ? 0.0 : image_variance[i];
    const double b = reference_variance.empty() ? 0.0 : reference_variance[i];
    if (!(a >= 0 && b >= 0 && std::isfinite(a) && std::isfinite(b))) return {.kind = Deviate::kInvalid};
    const double rounding = kRounding * std::max(std::abs(pair.value(i)), std::abs(pair.truth(i)));
    const double d = pair.difference(i);
    if (a + b == 0) {
      return {.kind = std::abs(d) <= rounding ? Deviate::kExactEqual : Deviate::kExactDifferent,
              .difference = d};
    }
    return {.kind = Deviate::kNoisy, .difference = d, .variance = a + b + rounding * rounding};
  }
};

/// Sums over the values of one channel in a block or in the image.
struct Moments {
  CompensatedSum squares, differences, variances;
  std::uint64_t values = 0;

  void add(const Deviate& deviate) {
    const double z = deviate.z();
    squares.add(z * z);
    differences.add(deviate.difference);
    variances.add(deviate.variance);
    ++values;
  }
  [[nodiscard]] double mean_z() const { return differences.value() / std::sqrt(variances.value()); }
};

/// Bonferroni's correction.
double corrected(double p, std::uint64_t tests) {
  return std::min(1.0, p * double(std::max<std::uint64_t>(tests, 1)));
}

void keep_larger(ZExtreme& extreme, const ZExtreme& other) {
  if (std::abs(other.z) > std::abs(extreme.z)) extreme = other;
}

/// Computes counts, fractions and the largest z of single values, and the moments of whole channels.
std::vector<Moments> look_at_values(const Input& input, ZTest& test) {
  const ImagePair& pair = input.pair;
  const std::size_t channels = pair.channels.size(), width = std::size_t(pair.window.width);
  std::vector<Moments> moments(channels);
  std::uint64_t above_1_96 = 0, above_2_58 = 0;
  for (std::size_t i = 0; i < pair.image.size(); ++i) {
    const Deviate deviate = input.at(i);
    test.exact_equal += deviate.kind == Deviate::kExactEqual;
    test.exact_different += deviate.kind == Deviate::kExactDifferent;
    test.invalid_variances += deviate.kind == Deviate::kInvalid;
    if (deviate.kind != Deviate::kNoisy) continue;
    moments[i % channels].add(deviate);
    const double z = deviate.z();
    const std::size_t pixel = i / channels;
    above_1_96 += std::abs(z) > 1.96;
    above_2_58 += std::abs(z) > 2.58;
    ++test.values;
    keep_larger(test.largest, {.z = z,
                               .x = pair.window.x + int(pixel % width),
                               .y = pair.window.y + int(pixel / width),
                               .channel = i % channels});
  }
  CompensatedSum squares;
  for (const Moments& channel : moments) squares.add(channel.squares.value());
  const double values = double(test.values);
  test.share_above_1_96 = double(above_1_96) / values;
  test.share_above_2_58 = double(above_2_58) / values;
  test.mean_square = squares.value() / values;
  test.largest.p = corrected(normal_two_sided_p(test.largest.z), test.values);
  return moments;
}

void look_at_block(const Input& input, int x0, int y0, ZTest& test) {
  const ImagePair& pair = input.pair;
  const std::size_t channels = pair.channels.size();
  std::vector<Moments> moments(channels);
  for (int y = y0; y < std::min(y0 + test.options.block, pair.window.height); ++y) {
    for (int x = x0; x < std::min(x0 + test.options.block, pair.window.width); ++x) {
      for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t pixel = std::size_t(y) * std::size_t(pair.window.width) + std::size_t(x);
        const Deviate deviate = input.at(pixel * channels + c);
        if (deviate.kind == Deviate::kNoisy) moments[c].add(deviate);
      }
    }
  }
  for (std::size_t c = 0; c < channels; ++c) {
    if (moments[c].values == 0) continue;
    ++test.blocks;
    ZExtreme block{
        .dof = double(moments[c].values), .x = pair.window.x + x0, .y = pair.window.y + y0, .channel = c};
    block.z = moments[c].mean_z();
    keep_larger(test.block_mean, block);
    block.z = moments[c].squares.value();
    block.p = chi_square_p(block.z, block.dof);
    const ZExtreme& worst = test.block_chi_square;
    const bool first = worst.dof == 0;
    // If both have p = 0, the more extreme one is chosen.
    if (first || block.p < worst.p || (block.p == worst.p && block.z / block.dof > worst.z / worst.dof)) {
      test.block_chi_square = block;
    }
  }
}

void look_at_image(const ImagePair& pair, const std::vector<Moments>& moments, ZTest& test) {
  std::uint64_t channels = 0;
  for (std::size_t c = 0; c < moments.size(); ++c) {
    const bool any = moments[c].values > 0;
    const double dof = double(moments[c].values);
    channels += any;
    test.channel_mean_z.push_back(any ? moments[c].mean_z() : std::numeric_limits<double>::quiet_NaN());
    test.channel_chi_square_p.push_back(any ? chi_square_p(moments[c].squares.value(), dof)
                                            : std::numeric_limits<double>::quiet_NaN());
    if (!any) continue;
    keep_larger(
        test.image_mean,
        {.z = test.channel_mean_z.back(), .dof = dof, .x = pair.window.x, .y = pair.window.y, .channel = c});
  }
  test.image_mean.p = corrected(normal_two_sided_p(test.image_mean.z), channels);
}

Expected<std::vector<float>> values_of(const Image& image, const ImagePair& pair,
                                       const LayerChannels& found) {
  const PixelWindow &a = image.data, &b = pair.window;
  if (a != b) {
    return fail(fmt::format("the variance is of {} x {} pixels from {},{}, the image of {} x {} from {},{}",
                            a.width, a.height, a.x, a.y, b.width, b.height, b.x, b.y));
  }
  const std::size_t channels = pair.channels.size();
  if (found.indices.size() != 1 && found.indices.size() != channels) {
    return fail(fmt::format("the variance has {} channels, the image {}", found.indices.size(), channels));
  }
  std::vector<float> values;
  values.reserve(pair.image.size());
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel) {
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t index = found.indices.size() == 1 ? found.indices[0] : found.indices[c];
      values.push_back(image.values[pixel * image.channels.size() + index]);
    }
  }
  return values;
}

}  // namespace

Expected<std::vector<float>> variance_layer(const Image& image, const ImagePair& pair,
                                            std::string_view layer) {
  const bool beauty = layer.empty() || layer == "beauty";
  const auto found = layer_channels(image, beauty ? "variance" : fmt::format("variance.{}", layer));
  if (!found) return std::unexpected(found.error());
  return values_of(image, pair, *found);
}

Expected<std::vector<float>> variance_image(const Image& image, const ImagePair& pair,
                                            std::string_view layer) {
  if (auto values = variance_layer(image, pair, layer)) return values;
  const auto found = layer_channels(image, {});
  if (!found) return std::unexpected(found.error());
  return values_of(image, pair, *found);
}

Expected<ZTest> z_test(const ImagePair& pair, std::span<const float> image_variance,
                       std::span<const float> reference_variance, const ZTestOptions& options) {
  for (const auto& variance : {image_variance, reference_variance}) {
    if (!variance.empty() && variance.size() != pair.image.size()) {
      return fail(fmt::format("{} variances for {} values", variance.size(), pair.image.size()));
    }
  }
  if (image_variance.empty() && reference_variance.empty()) return fail("neither image has a variance");
  if (options.block < 1) return fail(fmt::format("blocks of {} pixels", options.block));
  ZTest test;
  test.options = options;
  const Input input{pair, image_variance, reference_variance};
  const std::vector<Moments> moments = look_at_values(input, test);
  if (test.values == 0) {
    // No value has noise: images are equal or not.
    test.share_above_1_96 = test.share_above_2_58 = test.mean_square = 0;
  }
  for (int y = 0; y < pair.window.height; y += options.block) {
    for (int x = 0; x < pair.window.width; x += options.block) look_at_block(input, x, y, test);
  }
  test.block_mean.p = corrected(normal_two_sided_p(test.block_mean.z), test.blocks);
  test.block_chi_square.p = corrected(test.block_chi_square.p, test.blocks);
  look_at_image(pair, moments, test);

  const double limit = options.significance / kParts;
  test.consistent = test.exact_different == 0 && test.invalid_variances == 0 && test.largest.p >= limit &&
                    test.block_chi_square.p >= limit && test.block_mean.p >= limit &&
                    test.image_mean.p >= limit;
  return test;
}

std::vector<float> z_values(const ImagePair& pair, std::span<const float> image_variance,
                            std::span<const float> reference_variance) {
  const Input input{pair, image_variance, reference_variance};
  std::vector<float> values(pair.image.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Deviate deviate = input.at(i);
    if (deviate.kind == Deviate::kNoisy) values[i] = float(deviate.z());
    if (deviate.kind == Deviate::kExactDifferent) {
      values[i] = std::copysign(std::numeric_limits<float>::infinity(), float(deviate.difference));
    }
  }
  return values;
}

}  // namespace penumbra
