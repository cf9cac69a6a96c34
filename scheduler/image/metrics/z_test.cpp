#include "scheduler/image/metrics/z_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scheduler/image/metrics/compensated_sum.h"
#include "scheduler/image/metrics/distributions.h"

namespace penumbra {
namespace {

/// With fewer samples per pixel, variances are no more than guesses.
constexpr double kFewSamples = 4;
/// A difference is called visible if it is found with this probability.
constexpr double kPower = 0.9;

/// Sums over the values of one channel in a block or in the image.
struct Moments {
  CompensatedSum squares;
  NoiseModel::Region region;

  void add(const NoiseModel& model, std::size_t i, const Deviate& deviate) {
    const double z = deviate.z();
    squares.add(z * z);
    region.add(model, i);
  }
};

/// The mean over all channels of the magnitude of the reference's sum.
double mean_magnitude(const std::vector<Moments>& moments) {
  double sum = 0;
  for (const Moments& channel : moments) sum += std::abs(channel.region.truth());
  return sum / double(moments.size());
}

/// Bonferroni's correction.
double corrected(double p, std::uint64_t tests) {
  return std::min(1.0, p * double(std::max<std::uint64_t>(tests, 1)));
}

/// How many standard deviations a difference must have to be found with the probability kPower by one of
/// the tests, which looks at that many values.
double visible_deviation(const ZTest& test, std::uint64_t values) {
  const double p = test.limit() / double(std::max<std::uint64_t>(values, 1));
  return normal_two_sided_quantile(p) + normal_two_sided_quantile(2 * (1 - kPower));
}

void keep_larger(ZExtreme& extreme, const ZExtreme& other) {
  if (std::abs(other.z) > std::abs(extreme.z)) extreme = other;
}

/// Computes counts, fractions and the largest z of single values, and the moments of whole channels.
std::vector<Moments> look_at_values(const ImagePair& pair, const NoiseModel& model, ZTest& test) {
  const std::size_t channels = pair.channels.size(), width = std::size_t(pair.window.width);
  std::vector<Moments> moments(channels);
  std::uint64_t above_1_96 = 0, above_2_58 = 0;
  for (std::size_t i = 0; i < pair.image.size(); ++i) {
    const Deviate deviate = model.at(i);
    test.exact_equal += deviate.kind == Deviate::kExactEqual;
    test.exact_different += deviate.kind == Deviate::kExactDifferent;
    test.invalid_variances += deviate.kind == Deviate::kInvalid;
    test.unknown_variances += deviate.kind == Deviate::kUnknown;
    if (deviate.kind != Deviate::kNoisy) continue;
    moments[i % channels].add(model, i, deviate);
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

/// Adds relative visible differences of the block's channels to `visible`.
void look_at_block(const ImagePair& pair, const NoiseModel& model, int x0, int y0, double visible_z,
                   ZTest& test, std::vector<double>& visible) {
  const std::size_t channels = pair.channels.size();
  std::vector<Moments> moments(channels);
  for (int y = y0; y < std::min(y0 + test.options.block, pair.window.height); ++y) {
    for (int x = x0; x < std::min(x0 + test.options.block, pair.window.width); ++x) {
      for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t pixel = std::size_t(y) * std::size_t(pair.window.width) + std::size_t(x);
        const Deviate deviate = model.at(pixel * channels + c);
        if (deviate.kind == Deviate::kNoisy) moments[c].add(model, pixel * channels + c, deviate);
      }
    }
  }
  const double light = mean_magnitude(moments);
  for (std::size_t c = 0; c < channels; ++c) {
    const NoiseModel::Region& region = moments[c].region;
    if (region.values() == 0) continue;
    ++test.blocks;
    ZExtreme block{
        .dof = double(region.values()), .x = pair.window.x + x0, .y = pair.window.y + y0, .channel = c};
    block.z = region.z(model);
    if (light > 0) visible.push_back(region.visible_difference(model, visible_z) / light);
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

void look_at_image(const ImagePair& pair, const NoiseModel& model, const std::vector<Moments>& moments,
                   ZTest& test) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto channels =
      std::uint64_t(std::ranges::count_if(moments, [](const Moments& m) { return m.region.values() > 0; }));
  const double visible_z = visible_deviation(test, channels), light = mean_magnitude(moments);
  test.visible_image_difference = channels > 0 ? 0 : kNone;
  for (std::size_t c = 0; c < moments.size(); ++c) {
    const NoiseModel::Region& region = moments[c].region;
    const bool any = region.values() > 0;
    const double dof = double(region.values());
    test.channel_mean_z.push_back(any ? region.z(model) : kNone);
    test.channel_chi_square_p.push_back(any ? chi_square_p(moments[c].squares.value(), dof) : kNone);
    if (!any) continue;
    keep_larger(
        test.image_mean,
        {.z = test.channel_mean_z.back(), .dof = dof, .x = pair.window.x, .y = pair.window.y, .channel = c});
    test.visible_image_difference =
        std::max(test.visible_image_difference, region.visible_difference(model, visible_z) / light);
  }
  test.image_mean.p = corrected(normal_two_sided_p(test.image_mean.z), channels);
}

void look_at_blocks(const ImagePair& pair, const NoiseModel& model, ZTest& test) {
  const int side = test.options.block;
  const auto count = std::uint64_t((pair.window.width + side - 1) / side) *
                     std::uint64_t((pair.window.height + side - 1) / side) * pair.channels.size();
  const double visible_z = visible_deviation(test, count);
  std::vector<double> visible;
  for (int y = 0; y < pair.window.height; y += side) {
    for (int x = 0; x < pair.window.width; x += side)
      look_at_block(pair, model, x, y, visible_z, test, visible);
  }
  test.block_mean.p = corrected(normal_two_sided_p(test.block_mean.z), test.blocks);
  test.block_chi_square.p = corrected(test.block_chi_square.p, test.blocks);
  test.visible_block_difference = std::numeric_limits<double>::quiet_NaN();
  if (visible.empty()) return;
  const auto middle = visible.begin() + std::ptrdiff_t(visible.size() / 2);
  std::ranges::nth_element(visible, middle);
  test.visible_block_difference = *middle;
}

std::optional<SampleCounts> counts_of(const ImagePair& pair, const ImageNoise& noise) {
  if (!noise.estimated()) return std::nullopt;
  SampleCounts counts{.least = std::numeric_limits<double>::infinity()};
  CompensatedSum sum;
  std::uint64_t pixels = 0;
  for (std::size_t pixel = 0; pixel < pair.pixels(); ++pixel) {
    if (!pair.finite[pixel]) continue;
    const double samples = noise.samples[pixel];
    counts.least = std::min(counts.least, samples);
    counts.most = std::max(counts.most, samples);
    sum.add(samples);
    ++pixels;
  }
  counts.mean = sum.value() / double(pixels);
  return counts;
}

/// Why variances are not known well enough; empty: they are.
std::string why_too_few_samples(const ZTest& test) {
  for (const auto& [name, counts] : {std::pair("A", test.image_samples), {"B", test.reference_samples}}) {
    if (counts && counts->mean < kFewSamples)
      return fmt::format("the variances of {} are estimated from {:.3g} samples per pixel, fewer than {}",
                         name, counts->mean, kFewSamples);
  }
  const std::uint64_t known = test.values + test.exact_equal + test.exact_different + test.invalid_variances;
  if (test.unknown_variances > known)
    return fmt::format("most blocks of {0} x {0} pixels have fewer than {1} samples", test.options.block,
                       kLeastBlockSamples);
  return "";
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

std::vector<float> samples_per_pixel(const Image& image) {
  const auto channel = image.channel("samples.Y");
  if (!channel) return {};
  std::vector<float> samples;
  samples.reserve(image.pixels());
  for (std::size_t pixel = 0; pixel < image.pixels(); ++pixel)
    samples.push_back(image.values[pixel * image.channels.size() + *channel]);
  return samples;
}

Expected<ZTest> z_test(const ImagePair& pair, const ImageNoise& image, const ImageNoise& reference,
                       const ZTestOptions& options) {
  for (const ImageNoise* noise : {&image, &reference}) {
    if (!noise->variance.empty() && noise->variance.size() != pair.image.size())
      return fail(fmt::format("{} variances for {} values", noise->variance.size(), pair.image.size()));
    if (!noise->samples.empty() && noise->samples.size() != pair.pixels())
      return fail(fmt::format("{} numbers of samples for {} pixels", noise->samples.size(), pair.pixels()));
  }
  if (image.variance.empty() && reference.variance.empty()) return fail("neither image has a variance");
  if (options.block < 1) return fail(fmt::format("blocks of {} pixels", options.block));
  ZTest test;
  test.options = options;
  test.image_samples = counts_of(pair, image);
  test.reference_samples = counts_of(pair, reference);
  const NoiseModel model(pair, image, reference, options.block);
  const std::vector<Moments> moments = look_at_values(pair, model, test);
  if (test.values == 0) {
    // No value has noise: images are equal or not.
    test.share_above_1_96 = test.share_above_2_58 = test.mean_square = 0;
  }
  look_at_blocks(pair, model, test);
  look_at_image(pair, model, moments, test);

  const double limit = test.limit();
  test.consistent = test.exact_different == 0 && test.invalid_variances == 0 && test.largest.p >= limit &&
                    test.block_chi_square.p >= limit && test.block_mean.p >= limit &&
                    test.image_mean.p >= limit;
  test.too_few_samples = why_too_few_samples(test);
  return test;
}

std::vector<float> z_values(const ImagePair& pair, const ImageNoise& image, const ImageNoise& reference,
                            int block) {
  const NoiseModel model(pair, image, reference, block);
  std::vector<float> values(pair.image.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Deviate deviate = model.at(i);
    if (deviate.kind == Deviate::kNoisy) values[i] = float(deviate.z());
    if (deviate.kind == Deviate::kExactDifferent) {
      values[i] = std::copysign(std::numeric_limits<float>::infinity(), float(deviate.difference));
    }
  }
  return values;
}

}  // namespace penumbra
