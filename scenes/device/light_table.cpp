#include "scenes/device/light_table.h"

#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace penumbra {
namespace {

// Samplers give multiples of 2^-24 in [0, 1).
constexpr std::uint32_t kNumbers = 1u << 24;

/// choose_light's place in the table for the k-th number.
float position_of(std::uint32_t k, std::size_t count) { return float(k) * 0x1p-24f * float(count); }

/// The first k in [low, high) whose position is at least `place`, or `high`.
std::uint32_t first_at(float place, std::uint32_t low, std::uint32_t high, std::size_t count,
                       float from = 0) {
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (position_of(middle, count) - from < place)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/// The probabilities with which choose_light really picks each light, so that weights by 1 / pmf are exact:
/// with many lights only some numbers fall on each. A light with power is picked by one number at least, if
/// any falls on its place.
void count_choices(std::span<Light> lights, std::span<const double> power) {
  const std::size_t n = lights.size();
  std::vector<std::uint32_t> numbers(n);
  struct Place {
    std::uint32_t low, split, high;
  };
  std::vector<Place> places;
  for (std::uint32_t i = 0, low = 0; i < n; ++i) {
    Light& light = lights[i];
    const std::uint32_t high = i + 1 < n ? first_at(float(i + 1), low, kNumbers, n) : kNumbers;
    std::uint32_t split = first_at(light.alias_threshold, low, high, n, float(i));
    if (split == low && low < high && power[i] > 0) {
      light.alias_threshold = std::nextafter(position_of(low, n) - float(i), 2.0f);
      split = first_at(light.alias_threshold, low, high, n, float(i));
    }
    numbers[i] += split - low;
    numbers[std::size_t(light.alias)] += high - split;
    places.push_back({low, split, high});
    low = high;
  }
  std::vector<std::uint32_t> ranks(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto [low, split, high] = places[i];
    std::uint32_t &own = ranks[i], &alias = ranks[std::size_t(lights[i].alias)];
    lights[i].rank = int(own) - int(low);
    own += split - low;
    lights[i].alias_rank = int(alias) - int(split);
    alias += high - split;
  }
  for (std::size_t i = 0; i < n; ++i) lights[i].pmf = float(numbers[i]) * 0x1p-24f;
}

}  // namespace

void set_light_probabilities(std::span<Light> lights, std::span<const double> power) {
  const std::size_t n = lights.size();
  const double total = std::accumulate(power.begin(), power.end(), 0.0);
  std::vector<double> share(n);
  std::vector<std::size_t> small, large;
  for (std::size_t i = 0; i < n; ++i) {
    share[i] = power[i] / total * double(n);
    lights[i].alias_threshold = 1.0f;
    lights[i].alias = int(i);
    (share[i] < 1 ? small : large).push_back(i);
  }
  while (!small.empty() && !large.empty()) {
    const std::size_t s = small.back(), l = large.back();
    small.pop_back();
    lights[s].alias_threshold = float(share[s]);
    lights[s].alias = int(l);
    share[l] -= 1 - share[s];
    if (share[l] < 1) {
      large.pop_back();
      small.push_back(l);
    }
  }
  count_choices(lights, power);
}

}  // namespace penumbra
