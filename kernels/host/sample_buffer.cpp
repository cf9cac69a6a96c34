#include "kernels/host/sample_buffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace penumbra {

Expected<void> check_statistics(const SampleBuffer& buffer) {
  for (int p = 0; p < buffer.planes; ++p) {
    const bool is_deviation = p >= kDeviationR && p <= kDeviationB;
    const float least = is_deviation ? 0.0f : std::numeric_limits<float>::lowest();
    const std::span<const float> plane = buffer.plane(p);
    // A NaN is in no range.
    const auto bad = std::ranges::find_if(plane, [least](float value) {
      return !(value >= least && value <= std::numeric_limits<float>::max());
    });
    if (bad == plane.end()) continue;
    const auto pixel = std::size_t(bad - plane.begin()), width = std::size_t(buffer.width);
    return fail(fmt::format("{} as {} of its pixel ({}, {})", *bad,
                            is_deviation          ? "a deviation"
                            : p < kRadiancePlanes ? "a mean radiance"
                                                  : "a layer",
                            pixel % width, pixel / width));
  }
  return {};
}

}  // namespace penumbra
