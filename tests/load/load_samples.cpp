#include "tests/load/load_samples.h"

#include <algorithm>

namespace penumbra {

SampleBuffer load_samples(const RenderUnit& unit, int planes) {
  SampleBuffer buffer{
      .width = unit.width,
      .height = unit.height,
      .planes = planes,
      .sample_count = unit.sample_count,
      .nan = {},
      .infinite = {},
      .values = std::vector<float>(std::size_t(unit.width) * std::size_t(unit.height) * std::size_t(planes))};
  const std::uint32_t name = (std::uint32_t(unit.x) * 73856093u) ^ (std::uint32_t(unit.y) * 19349663u) ^
                             (unit.first_sample * 83492791u);
  const float value = float(name % 4099u) / 4099.0f;
  for (int plane = 0; plane < planes; ++plane)
    std::ranges::fill(buffer.plane(plane), value / float(1 + plane));
  return buffer;
}

}  // namespace penumbra
