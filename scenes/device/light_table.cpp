#include "scenes/device/light_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace penumbra {
namespace {

constexpr std::size_t kLeastCells = 1024, kCellsPerLight = 16;
constexpr int kCurveBits = 20;  // bits of each coordinate along the curve

/// The powers relative to the largest, which becomes 1.
std::vector<double> relative(std::span<const double> power) {
  const double largest = std::ranges::max(power);
  std::vector<double> shares;
  for (const double p : power) {
    // If there are infinite powers, only these get probabilities.
    const double share = std::isfinite(largest) ? p / largest : (p == largest ? 1.0 : 0.0);
    shares.push_back(p > 0 ? std::max(share, std::numeric_limits<double>::min()) : 0.0);
  }
  return shares;
}

/// The number of cells of each light, in total `cells`. A light whose share is less than one cell gets one.
/// The others divide the rest in proportion by the largest-remainder method.
std::vector<std::size_t> deal_cells(const std::vector<double>& shares, std::size_t cells) {
  std::vector<std::size_t> dealt(shares.size(), 0);
  double sum = 0;
  auto rest = double(cells);
  std::vector<std::size_t> by_share;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    sum += shares[i];
    if (shares[i] > 0) by_share.push_back(i);
  }
  std::ranges::sort(by_share, {}, [&](std::size_t i) { return std::pair(shares[i], i); });
  // Smallest first: the excess of small lights is taken from the others.
  std::size_t small = 0;
  for (; small + 1 < by_share.size() && shares[by_share[small]] * rest < sum; ++small) {
    dealt[by_share[small]] = 1;
    sum -= shares[by_share[small]];
    rest -= 1;
  }
  if (by_share.empty()) return dealt;
  std::size_t left = cells - small;
  std::vector<std::pair<double, std::size_t>> remainders;
  for (std::size_t k = small; k < by_share.size(); ++k) {
    const std::size_t i = by_share[k];
    const double exact = shares[i] / sum * rest;
    dealt[i] = std::clamp(std::size_t(exact), std::size_t{1}, left - (by_share.size() - 1 - k));
    left -= dealt[i];
    remainders.emplace_back(double(dealt[i]) - exact, i);
  }
  std::ranges::sort(remainders);
  for (std::size_t k = 0; left > 0; k = (k + 1) % remainders.size(), --left) ++dealt[remainders[k].second];
  return dealt;
}

/// Moves each bit to every third position.
std::uint64_t spread_bits(std::uint32_t x) {
  std::uint64_t bits = 0;
  for (int k = 0; k < kCurveBits; ++k) bits |= std::uint64_t(x >> k & 1u) << (3 * k);
  return bits;
}

/// The position of each light along a Morton curve through the bounding box. Lights without a position come
/// first, infinite ones last.
std::vector<std::uint64_t> places_on_curve(std::span<const LightBounds> bounds) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const LightBounds& b : bounds) {
    if (b.infinite) continue;
    low = glm::min(low, 0.5 * (b.low + b.high));
    high = glm::max(high, 0.5 * (b.low + b.high));
  }
  const double size = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  std::vector<std::uint64_t> places;
  for (const LightBounds& b : bounds) {
    std::uint64_t place = std::numeric_limits<std::uint64_t>::max();
    if (!b.infinite) {
      place = 0;
      const bool somewhere = size > 0 && glm::all(glm::lessThanEqual(b.low, b.high));
      const glm::dvec3 p = somewhere ? (0.5 * (b.low + b.high) - low) / size : glm::dvec3(0);
      for (int axis = 0; axis < 3; ++axis)
        place |= spread_bits(std::uint32_t(p[axis] * ((1 << kCurveBits) - 1))) << axis;
    }
    places.push_back(place);
  }
  return places;
}

}  // namespace

std::vector<int> set_light_probabilities(std::span<Light> lights, std::span<const double> power,
                                         std::span<const LightBounds> bounds) {
  const std::size_t count =
      std::clamp(std::bit_ceil(kCellsPerLight * lights.size()), kLeastCells, std::size_t{1} << 24);
  const std::vector<std::size_t> dealt = deal_cells(relative(power), count);
  const std::vector<std::uint64_t> places = places_on_curve(bounds);
  std::vector<int> order(lights.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](int i) { return std::pair(places[std::size_t(i)], i); });
  std::vector<int> cells;
  for (const int i : order) {
    Light& light = lights[std::size_t(i)];
    const std::size_t own = dealt[std::size_t(i)];
    light.pmf = float(double(own) / double(count));
    light.start = int(cells.size() * ((std::size_t{1} << 24) / count));
    cells.insert(cells.end(), own, i);
  }
  if (cells.empty()) cells.assign(count, 0);  // no light has power, so none has a probability
  return cells;
}

}  // namespace penumbra
