#include "tests/support/fake_samples.h"

#include <cmath>

namespace penumbra {
namespace {

std::uint32_t scramble(std::uint32_t bits) {  // any well-mixing function would do
  bits = (bits ^ (bits >> 16)) * 0x7feb352du;
  bits = (bits ^ (bits >> 15)) * 0x846ca68bu;
  return bits ^ (bits >> 16);
}

/// In [0, 1), different for each channel.
double sample_value(int x, int y, std::uint32_t sample, int channel) {
  const std::uint32_t pixel = scramble(std::uint32_t(x) + 0x9e3779b9u * scramble(std::uint32_t(y)));
  return scramble(scramble(pixel + sample) + std::uint32_t(channel)) * 0x1p-32;
}

void fill_pixel(const RenderUnit& unit, int x, int y, SampleBuffer& buffer) {
  const std::size_t at = std::size_t(y) * std::size_t(unit.width) + std::size_t(x);
  for (int channel = 0; channel < 3; ++channel) {
    double mean = 0, m2 = 0;
    for (std::uint32_t i = 0; i < unit.sample_count; ++i) {
      const double value = sample_value(unit.x + x, unit.y + y, unit.first_sample + i, channel);
      const double difference = value - mean;
      mean += difference / (i + 1);
      m2 += difference * (value - mean);
    }
    buffer.plane(kMeanR + channel)[at] = float(mean);
    buffer.plane(kDeviationR + channel)[at] = float(std::sqrt(m2 / unit.sample_count));
  }
  for (int plane = kRadiancePlanes; plane < buffer.planes; ++plane) {
    buffer.plane(plane)[at] = float(sample_value(unit.x + x, unit.y + y, unit.first_sample, plane));
  }
  for (std::uint32_t i = 0; i < unit.sample_count; ++i) {
    const std::uint32_t index = unit.first_sample + i;
    if (sample_value(unit.x + x, unit.y + y, index, 99) < 1e-3)
      buffer.flagged[BAD_NAN].add(
          {.count = 1, .x = unit.x + x, .y = unit.y + y, .sample = index, .source = {}});
  }
}

}  // namespace

SampleBuffer fake_samples(const RenderUnit& unit, const FilmLayers& layers, float shift) {
  SampleBuffer buffer{.width = unit.width,
                      .height = unit.height,
                      .planes = layers.planes(),
                      .sample_count = unit.sample_count,
                      .values = std::vector<float>(std::size_t(unit.width) * std::size_t(unit.height) *
                                                   std::size_t(layers.planes()))};
  for (int y = 0; y < unit.height; ++y) {
    for (int x = 0; x < unit.width; ++x) fill_pixel(unit, x, y, buffer);
  }
  for (int plane = kMeanR; plane <= kMeanB; ++plane)
    for (float& mean : buffer.plane(plane)) mean += shift;
  return buffer;
}

}  // namespace penumbra
