#include "scheduler/report/reference.h"

#include <cmath>

#include "scheduler/image/metrics/compensated_sum.h"

namespace penumbra {

Expected<ImagePair> Reference::pair(const Image& image) const {
  return pair_images(image, first, second ? &*second : nullptr);
}

double halves_z(const Image& a, const Image& b) {
  const auto pair = pair_images(a, b);
  if (!pair) return std::nan("");
  const std::size_t channels = pair->channels.size();
  CompensatedSum sum, squares;
  double pixels = 0;
  for (std::size_t p = 0; p < pair->pixels(); ++p) {
    if (pair->finite[p] == 0) continue;
    double difference = 0;
    for (std::size_t c = 0; c < channels; ++c)
      difference += pair->difference(p * channels + c) / double(channels);
    sum.add(difference);
    squares.add(difference * difference);
    ++pixels;
  }
  const double mean = sum.value() / pixels;
  const double variance = std::max(0.0, squares.value() / pixels - mean * mean);
  return mean == 0 ? 0 : mean / std::sqrt(variance / pixels);
}

std::optional<ReferenceNoise> reference_noise(const Image& reference, double epsilon) {
  const auto variance = layer_channels(reference, "variance");
  const auto beauty = reference.beauty_channels();
  if (!variance || variance->indices.size() != 3 || !beauty) return std::nullopt;
  CompensatedSum plain, relative;
  std::size_t values = 0;
  for (std::size_t p = 0; p < reference.pixels(); ++p) {
    const float* pixel = reference.values.data() + p * reference.channels.size();
    for (std::size_t c = 0; c < 3; ++c) {
      const double v = pixel[variance->indices[c]], mean = pixel[(*beauty)[c]];
      if (!std::isfinite(v) || !std::isfinite(mean)) continue;
      plain.add(v);
      relative.add(v / (mean * mean + epsilon));
      ++values;
    }
  }
  if (values == 0) return std::nullopt;
  return ReferenceNoise{plain.value() / double(values), relative.value() / double(values)};
}

}  // namespace penumbra
