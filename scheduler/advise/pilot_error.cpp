#include "scheduler/advise/pilot_error.h"

#include <algorithm>

#include "scheduler/image/metrics/error_metrics.h"

namespace penumbra {
namespace {

constexpr int kBlock = 4;
static_assert(kPilotSide % kBlock == 0 && kErrorBlock == kBlock);

/// Mean and variance of the batches' values.
struct Spread {
  double mean = 0, variance = 0;
};

template <typename ValueOf>
Spread spread_of(const ValueOf& value_of) {
  Spread spread;
  for (int b = 0; b < kPilotBatches; ++b) spread.mean += value_of(b) / kPilotBatches;
  for (int b = 0; b < kPilotBatches; ++b) {
    const double distance = value_of(b) - spread.mean;
    spread.variance += distance * distance / (kPilotBatches - 1);
  }
  return spread;
}

/// Calls use(tile, first value of the tile).
template <typename Use>
void each_tile(std::span<const PilotTile> tiles, const Use& use) {
  std::size_t first = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    use(t, first);
    first += 3 * std::size_t(tiles[t].width) * std::size_t(tiles[t].height);
  }
}

double over_reference(double square, double reference) {
  return square / (reference * reference + kRelativeEpsilon);
}

}  // namespace

std::vector<double> pilot_reference(std::span<const Pilot* const> pilots, std::span<const PilotTile> tiles) {
  std::vector<double> reference(pilots.front()->within.size());
  const double share = 1.0 / double(pilots.size() * kPilotBatches);
  for (const Pilot* pilot : pilots)
    for (const std::vector<float>& means : pilot->means)
      for (std::size_t i = 0; i < reference.size(); ++i) reference[i] += share * double(means[i]);
  each_tile(tiles, [&](std::size_t t, std::size_t first) {
    const PilotTile& tile = tiles[t];
    for (int y = 0; y < tile.height; y += kBlock)
      for (int x = 0; x < tile.width; x += kBlock)
        for (std::size_t c = 0; c < 3; ++c) {
          const int right = std::min(x + kBlock, tile.width), down = std::min(y + kBlock, tile.height);
          const auto each = [&](const auto& use) {
            for (int v = y; v < down; ++v)
              for (int u = x; u < right; ++u) use(reference[first + 3 * std::size_t(v * tile.width + u) + c]);
          };
          double sum = 0;
          each([&](double value) { sum += value; });
          each([&](double& value) { value = sum / double((right - x) * (down - y)); });
        }
  });
  return reference;
}

std::vector<TileError> tile_errors(const Pilot& pilot, bool has_photons, std::span<const PilotTile> tiles,
                                   std::span<const double> reference) {
  std::vector<TileError> errors(tiles.size());
  each_tile(tiles, [&](std::size_t t, std::size_t first) {
    const std::size_t values = 3 * std::size_t(tiles[t].width) * std::size_t(tiles[t].height);
    double all = 0, of_samples = 0;
    for (std::size_t i = first; i < first + values; ++i) {
      const double variance =
          spread_of([&](int b) { return double(pilot.means[std::size_t(b)][i]); }).variance;
      all += over_reference(variance, reference[i]) / 3;
      of_samples += over_reference(pilot.within[i], reference[i]) / 3;
    }
    // Points of low discrepancy have less variance than their samples show.
    errors[t].photons = has_photons ? std::clamp(all - of_samples, 0.0, all) : 0;
    errors[t].paths = (all - errors[t].photons) * kPilotSamples;
  });
  return errors;
}

void add_missed(const Pilot& pilot, const Pilot& other, std::span<const PilotTile> tiles,
                std::span<const double> reference, std::vector<TileError>& errors) {
  each_tile(tiles, [&](std::size_t t, std::size_t first) {
    const std::size_t pixels = std::size_t(tiles[t].width) * std::size_t(tiles[t].height);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto mean_of = [&](const Pilot& of) {
        return spread_of([&](int b) {
          double sum = 0;
          for (std::size_t p = 0; p < pixels; ++p) sum += double(of.means[std::size_t(b)][first + 3 * p + c]);
          return sum / double(pixels);
        });
      };
      const Spread own = mean_of(pilot), others = mean_of(other);
      if (own.mean >= others.mean) continue;
      const double lack = others.mean - own.mean;
      const double excess = lack * lack - (own.variance + others.variance) / kPilotBatches;
      double mean_reference = 0;
      for (std::size_t p = 0; p < pixels; ++p)
        mean_reference += reference[first + 3 * p + c] / double(pixels);
      if (excess > 0)
        errors[t].missed +=
            over_reference(excess, mean_reference) * double(pixels) * (kPilotBatches * kPilotSamples) / 3;
    }
  });
}

}  // namespace penumbra
