#include "tests/load/load_samples.h"

#include <algorithm>

namespace penumbra {

namespace {

/// In [0, 1), and a function of the unit's place and samples.
float value_of(const RenderUnit& unit) {
  const std::uint32_t name = (std::uint32_t(unit.x) * 73856093u) ^ (std::uint32_t(unit.y) * 19349663u) ^
                             (unit.first_sample * 83492791u);
  return float(name % 4099u) / 4099.0f;
}

}  // namespace

double load_seconds(const RenderUnit& unit, double mean) {
  return mean * (0.8 + 0.4 * double(value_of(unit)));
}

SampleBuffer load_samples(const RenderUnit& unit, int planes) {
  SampleBuffer buffer{
      .width = unit.width,
      .height = unit.height,
      .planes = planes,
      .sample_count = unit.sample_count,
      .flagged = {},
      .values = std::vector<float>(std::size_t(unit.width) * std::size_t(unit.height) * std::size_t(planes))};
  const float value = value_of(unit);
  for (int plane = 0; plane < planes; ++plane)
    std::ranges::fill(buffer.plane(plane), value / float(1 + plane));
  return buffer;
}

}  // namespace penumbra
