#include "kernels/host/sample_buffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace penumbra {

Expected<void> check_statistics(const SampleBuffer& buffer) {
  return check_statistics(buffer, 0, std::size_t(buffer.planes) * buffer.pixels());
}

Expected<void> check_statistics(const SampleBuffer& buffer, std::size_t begin, std::size_t end) {
  const std::size_t pixels = buffer.pixels();
  while (begin < end) {
    const int p = int(begin / pixels);
    const std::size_t plane_begin = std::size_t(p) * pixels;
    const bool is_deviation = p >= kDeviationR && p <= kDeviationB;
    const float least = is_deviation ? 0.0f : std::numeric_limits<float>::lowest();
    const std::span<const float> values =
        std::span(buffer.values).subspan(begin, std::min(end, plane_begin + pixels) - begin);
    // The comparison also finds NaN.
    const auto is_good = [least](float value) {
      return bool(int(value >= least) & int(value <= std::numeric_limits<float>::max()));
    };
    // Counting is several times faster than searching.
    if (std::size_t(std::ranges::count_if(values, is_good)) == values.size()) {
      begin += values.size();
      continue;
    }
    const auto bad = std::ranges::find_if_not(values, is_good);
    const std::size_t pixel = begin + std::size_t(bad - values.begin()) - plane_begin;
    return fail(fmt::format("{} as {} of its pixel ({}, {})", *bad,
                            is_deviation          ? "a deviation"
                            : p < kRadiancePlanes ? "a mean radiance"
                                                  : "a layer",
                            pixel % std::size_t(buffer.width), pixel / std::size_t(buffer.width)));
  }
  return {};
}

void take_mattes(SampleBuffer& buffer) {
  const std::size_t pixels = buffer.pixels();
  const int pairs = matte_pairs(int(buffer.sample_count));
  const float* planes = buffer.values.data() + buffer.values.size() - 2 * std::size_t(pairs) * pixels;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> met;
  buffer.mattes.clear();
  buffer.mattes.reserve(4 * pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    met.clear();
    for (std::size_t k = 0; k < std::size_t(pairs); ++k) {
      const float matte = planes[2 * k * pixels + pixel], count = planes[(2 * k + 1) * pixels + pixel];
      if (count > 0) met.emplace_back(std::uint32_t(matte), std::uint32_t(count));
    }
    std::ranges::sort(met);
    buffer.mattes.push_back(std::uint32_t(met.size()));
    for (const auto& [matte, count] : met) buffer.mattes.insert(buffer.mattes.end(), {matte, count});
  }
  buffer.values.resize(std::size_t(buffer.planes) * pixels);
}

Expected<void> check_mattes(const SampleBuffer& buffer, int matte_count) {
  if (matte_count == 0)
    return buffer.mattes.empty() ? Expected<void>() : fail("mattes, of which the scene has none");
  std::span<const std::uint32_t> rest = buffer.mattes;
  const auto most = std::uint32_t(matte_pairs(int(buffer.sample_count)));
  for (std::size_t pixel = 0; pixel < buffer.pixels(); ++pixel) {
    if (rest.empty() || rest[0] > most || rest.size() - 1 < 2 * std::size_t(rest[0]))
      return fail("a list of mattes that is no list of its pixels");
    const auto pairs = rest.subspan(1, 2 * std::size_t(rest[0]));
    rest = rest.subspan(1 + pairs.size());
    std::uint64_t samples = 0;
    for (std::size_t k = 0; k < pairs.size(); k += 2) {
      if (pairs[k] > std::uint32_t(matte_count) || (k > 0 && pairs[k] <= pairs[k - 2]))
        return fail(fmt::format("the matte {}, which is unknown or out of its order", pairs[k]));
      if (pairs[k + 1] == 0) return fail("a matte that no sample met");
      samples += pairs[k + 1];
    }
    if (samples != buffer.sample_count)
      return fail(fmt::format("mattes of {} samples in a pixel of {}", samples, buffer.sample_count));
  }
  if (!rest.empty()) return fail("mattes of more pixels than there are");
  return {};
}

}  // namespace penumbra
