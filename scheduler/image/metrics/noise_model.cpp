#include "scheduler/image/metrics/noise_model.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

/// Allows for the rounding of float arithmetic, relative to the larger value.
constexpr double kRounding = 0x1p-18;
/// A variance needs two samples.
constexpr float kLeastSamples = 2;

double variance_at(const ImageNoise& noise, std::size_t i) {
  return noise.variance.empty() ? 0.0 : double(noise.variance[i]);
}

}  // namespace

double Deviate::z() const { return difference / std::sqrt(variance); }

NoiseModel::NoiseModel(const ImagePair& pair, const ImageNoise& image, const ImageNoise& reference, int block)
    : pair_(pair), block_(block), image_{image, {}}, reference_{reference, {}} {
  blocks_across_ = std::size_t((pair.window.width + block - 1) / block);
  const std::size_t blocks = blocks_across_ * std::size_t((pair.window.height + block - 1) / block);
  block_variance_.assign(blocks * pair.channels.size(), 0.0);
  block_known_.assign(blocks, 1);
  for (const ImageNoise* noise : {&image, &reference}) {
    if (noise->estimated()) add_blocks(*noise);
  }
  image_.portion = portions(image, true);
  reference_.portion = portions(reference, false);
}

std::size_t NoiseModel::block_of(std::size_t pixel) const {
  const std::size_t width = std::size_t(pair_.window.width), side = std::size_t(block_);
  return pixel / width / side * blocks_across_ + pixel % width / side;
}

void NoiseModel::add_blocks(const ImageNoise& noise) {
  const std::size_t channels = pair_.channels.size();
  std::vector<double> variance(block_variance_.size(), 0.0), samples(block_known_.size(), 0.0);
  std::vector<double> pixels(block_known_.size(), 0.0);
  for (std::size_t pixel = 0; pixel < pair_.pixels(); ++pixel) {
    if (!pair_.finite[pixel] || !(noise.samples[pixel] >= kLeastSamples)) continue;
    const std::size_t block = block_of(pixel);
    samples[block] += double(noise.samples[pixel]);
    ++pixels[block];
    for (std::size_t c = 0; c < channels; ++c) {
      const double of_sample = double(noise.variance[pixel * channels + c]) * double(noise.samples[pixel]);
      if (std::isfinite(of_sample)) variance[block * channels + c] += std::max(0.0, of_sample);
    }
  }
  for (std::size_t block = 0; block < block_known_.size(); ++block) {
    if (samples[block] < kLeastBlockSamples) block_known_[block] = 0;
    for (std::size_t c = 0; c < channels && pixels[block] > 0; ++c) {
      double& larger = block_variance_[block * channels + c];
      larger = std::max(larger, variance[block * channels + c] / pixels[block]);
    }
  }
}

std::vector<double> NoiseModel::portions(const ImageNoise& noise, bool of_image) const {
  const std::size_t channels = pair_.channels.size();
  std::vector<double> portion(channels, 0.0);
  if (!noise.estimated()) return portion;
  std::vector<CompensatedSum> variance(channels), light(channels);
  for (std::size_t i = 0; i < pair_.image.size(); ++i) {
    const double of_sample = double(noise.variance[i]) * double(noise.samples[i / channels]);
    if (!pair_.finite[i / channels] || !(of_sample >= 0) || !std::isfinite(of_sample)) continue;
    variance[i % channels].add(of_sample);
    light[i % channels].add(std::abs(of_image ? pair_.value(i) : pair_.truth(i)));
  }
  for (std::size_t c = 0; c < channels; ++c) {
    if (light[c].value() > 0) portion[c] = variance[c].value() / light[c].value();
  }
  return portion;
}

double NoiseModel::variance_of(const Side& side, const Side& other, std::size_t i) const {
  const double own = variance_at(side.noise, i);
  if (!side.noise.estimated()) return own;
  const std::size_t channels = pair_.channels.size(), pixel = i / channels;
  const double samples = side.noise.samples[pixel];
  double of_sample = std::max(own * samples, block_variance_[block_of(pixel) * channels + i % channels]);
  if (other.noise.estimated())
    of_sample = std::max(of_sample, double(other.noise.variance[i]) * double(other.noise.samples[pixel]));
  return of_sample / samples;
}

Deviate NoiseModel::at(std::size_t i) const {
  const std::size_t channels = pair_.channels.size(), pixel = i / channels, channel = i % channels;
  if (!pair_.finite[pixel]) return {};
  const double a = variance_at(image_.noise, i), b = variance_at(reference_.noise, i);
  if (!(a >= 0 && b >= 0 && std::isfinite(a) && std::isfinite(b))) return {.kind = Deviate::kInvalid};
  for (const Side* side : {&image_, &reference_}) {
    if (!side->noise.estimated()) continue;
    if (!(side->noise.samples[pixel] >= kLeastSamples) || !block_known_[block_of(pixel)])
      return {.kind = Deviate::kUnknown};
  }
  const double rounding = kRounding * std::max(std::abs(pair_.value(i)), std::abs(pair_.truth(i)));
  const double d = pair_.difference(i);
  if (a + b == 0 && std::abs(d) <= rounding) return {.kind = Deviate::kExactEqual, .difference = d};
  double variance = variance_of(image_, reference_, i) + variance_of(reference_, image_, i);
  const Side& lacking = d < 0 ? image_ : reference_;
  if (lacking.noise.estimated())
    variance += lacking.portion[channel] * std::abs(d) / double(lacking.noise.samples[pixel]);
  if (variance == 0) return {.kind = Deviate::kExactDifferent, .difference = d};
  return {.kind = Deviate::kNoisy, .difference = d, .variance = variance + rounding * rounding};
}

void NoiseModel::Region::add(const NoiseModel& model, std::size_t i) {
  const ImagePair& pair = model.pair_;
  const std::size_t pixel = i / pair.channels.size();
  channel_ = i % pair.channels.size();
  ++values_;
  const double rounding = kRounding * std::max(std::abs(pair.value(i)), std::abs(pair.truth(i)));
  rounding_.add(rounding * rounding);
  const ImageNoise &a = model.image_.noise, &b = model.reference_.noise;
  image_.sum.add(pair.value(i));
  reference_.sum.add(pair.truth(i));
  image_.variance.add(variance_at(a, i));
  reference_.variance.add(variance_at(b, i));
  if (a.estimated()) image_.samples.add(double(a.samples[pixel]));
  if (b.estimated()) reference_.samples.add(double(b.samples[pixel]));
  if (!a.estimated() || !b.estimated()) return;
  const double ratio = double(a.samples[pixel]) / double(b.samples[pixel]);
  image_.from_other.add(double(b.variance[i]) / ratio);
  reference_.from_other.add(double(a.variance[i]) * ratio);
}

double NoiseModel::Region::base_variance() const {
  return std::max(image_.variance.value(), image_.from_other.value()) +
         std::max(reference_.variance.value(), reference_.from_other.value()) + rounding_.value();
}

double NoiseModel::Region::missing_light(const NoiseModel& model, bool of_image) const {
  const Side& side = of_image ? model.image_ : model.reference_;
  const double samples = (of_image ? image_ : reference_).samples.value();
  return samples > 0 ? side.portion[channel_] * double(values_) / samples : 0.0;
}

double NoiseModel::Region::variance(const NoiseModel& model) const {
  const double d = difference();
  return base_variance() + missing_light(model, d < 0) * std::abs(d);
}

double NoiseModel::Region::z(const NoiseModel& model) const {
  return difference() / std::sqrt(variance(model));
}

double NoiseModel::Region::visible_difference(const NoiseModel& model, double z) const {
  // d^2 = z^2 (V + m d)
  const double m = std::max(missing_light(model, true), missing_light(model, false));
  const double half = 0.5 * z * z * m;
  return half + std::sqrt(half * half + z * z * base_variance());
}

}  // namespace penumbra
