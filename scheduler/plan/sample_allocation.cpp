#include "scheduler/plan/sample_allocation.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <span>
#include <tuple>

namespace penumbra {
namespace {

constexpr std::uint32_t kLeastShare = 8, kMostShare = 16;  // relative to the mean: from an eighth to 16 times
constexpr std::uint64_t kMostSpp = std::uint64_t(1) << 31;  // as many as sample numbers allow

/// The side in pixels of the squares over which the pilot's mean is taken. Its single pixels are too noisy to
/// divide by.
constexpr int kSquare = 4;

/// The relative variance of one sample, estimated from the few samples of each pixel.
double relative_variance(const SampleBuffer& result) {
  const double per_square = double(result.sample_count) / std::max(1.0, double(result.sample_count) - 1);
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const std::span<const float> means = result.plane(kMeanR + c), deviations = result.plane(kDeviationR + c);
    for (int top = 0; top < result.height; top += kSquare)
      for (int left = 0; left < result.width; left += kSquare) {
        double mean = 0, squares = 0;
        int pixels = 0;
        for (int y = top; y < std::min(top + kSquare, result.height); ++y)
          for (int x = left; x < std::min(left + kSquare, result.width); ++x, ++pixels) {
            const std::size_t i = std::size_t(y) * std::size_t(result.width) + std::size_t(x);
            mean += means[i];
            squares += double(deviations[i]) * deviations[i] * per_square;
          }
        mean /= pixels;
        sum += squares / (mean * mean + 0.01);
      }
  }
  return sum / (3.0 * double(result.pixels()));
}

}  // namespace

SampleAllocation::SampleAllocation(const TileGrid& grid)
    : grid_(grid),
      least_spp_(std::max(1u, grid.spp() / kLeastShare)),
      most_spp_(std::uint32_t(std::min(std::uint64_t(grid.spp()) * kMostShare, kMostSpp))),
      pilots_missing_(grid.tiles()),
      tiles_(grid.tiles()) {}

void SampleAllocation::add_pilot(std::uint32_t tile, const SampleBuffer& result) {
  end_pilot(tile, relative_variance(result));
}

void SampleAllocation::forget_pilot(std::uint32_t tile) {
  if (is_made()) return;
  if (tiles_[tile].has_pilot) ++pilots_missing_;
  tiles_[tile] = Tile();
}

void SampleAllocation::end_pilot(std::uint32_t tile, double variance) {
  Tile& of = tiles_[tile];
  if (of.has_pilot) {
    contradicted_ = contradicted_ || variance != of.variance;
    return;
  }
  of.has_pilot = true;
  of.variance = variance;
  if (--pilots_missing_ == 0) allocate();
}

/// Starts with the smallest numbers and repeatedly doubles that of the tile that lacks most, as long as there
/// are samples left.
void SampleAllocation::allocate() {
  double sum = 0;
  std::uint64_t known = 0, left = grid_.samples(grid_.passes());
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    if (tiles_[tile].variance != kUnknown) sum += tiles_[tile].variance, ++known;
    tiles_[tile].spp = least_spp_;
    left -= grid_.pixels(tile) * least_spp_;
  }
  const double mean = known > 0 ? sum / double(known) : 1;
  struct Doubling {
    double gain;  // variance / n^2.5, so that n becomes proportional to variance^0.4
    std::uint32_t spp, tile;
    bool operator<(const Doubling& other) const {
      // Among equal gains, for example in a pilot without noise, the tile with the fewest samples comes
      // first.
      return std::tuple(gain, other.spp, other.tile) < std::tuple(other.gain, spp, tile);
    }
  };
  std::priority_queue<Doubling> next;
  const auto queue = [&](std::uint32_t tile) {
    const Tile& of = tiles_[tile];
    const double variance = of.variance != kUnknown ? of.variance : mean;
    const double n = of.spp;
    if (of.spp <= most_spp_ / 2) next.push({variance / (n * n * std::sqrt(n)), of.spp, tile});
  };
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) queue(tile);
  for (; !next.empty(); next.pop()) {
    const std::uint32_t tile = next.top().tile;
    const std::uint64_t cost = grid_.pixels(tile) * tiles_[tile].spp;
    if (cost > left) continue;
    left -= cost;
    tiles_[tile].spp *= 2;
    queue(tile);
  }
}

std::uint32_t SampleAllocation::passes(std::uint32_t tile) const {
  if (!is_made()) return kPilotPasses;
  return kPilotPasses + (tiles_[tile].spp + grid_.samples_per_pass() - 1) / grid_.samples_per_pass();
}

std::uint32_t SampleAllocation::most_passes() const {
  return kPilotPasses + (most_spp_ + grid_.samples_per_pass() - 1) / grid_.samples_per_pass();
}

std::uint64_t SampleAllocation::counted(std::uint32_t tile, std::uint32_t passes) const {
  // The pilot is shown until something better is there.
  if (passes <= kPilotPasses) return passes * kPilotSpp;
  return std::min<std::uint64_t>(std::uint64_t(passes - kPilotPasses) * grid_.samples_per_pass(),
                                 tiles_[tile].spp);
}

std::uint64_t SampleAllocation::rendered(std::uint32_t tile, std::uint32_t passes) const {
  return counted(tile, passes) + (passes > kPilotPasses ? kPilotPasses * kPilotSpp : 0);
}

RenderUnit SampleAllocation::unit(std::uint32_t tile, std::uint32_t pass) const {
  RenderUnit unit = grid_.unit(tile, 0);
  const bool is_pilot = pass < kPilotPasses;
  unit.spp = is_pilot ? kPilotSpp : tiles_[tile].spp;
  unit.sequence = is_pilot ? 1 : 0;
  unit.first_sample = is_pilot ? 0 : (pass - kPilotPasses) * grid_.samples_per_pass();
  unit.sample_count = is_pilot ? kPilotSpp : std::min(grid_.samples_per_pass(), unit.spp - unit.first_sample);
  return unit;
}

bool SampleAllocation::has_gaps() const {
  return std::ranges::any_of(tiles_,
                             [](const Tile& tile) { return tile.has_pilot && tile.variance == kUnknown; });
}

void SampleAllocation::write(ByteWriter& bytes) const {
  bytes.u64(contradicted_ ? 1 : 0);
  for (const Tile& tile : tiles_) {
    bytes.u64(tile.has_pilot ? 1 : 0);
    bytes.f64(tile.variance);
    bytes.u64(tile.spp);
  }
}

Expected<void> SampleAllocation::read(ByteReader& bytes) {
  contradicted_ = bytes.u64() != 0;
  pilots_missing_ = 0;
  for (Tile& tile : tiles_) {
    tile.has_pilot = bytes.u64() != 0;
    tile.variance = bytes.f64();
    const std::uint64_t spp = bytes.u64();
    const bool is_variance = std::isfinite(tile.variance) && tile.variance >= 0;
    if (spp > most_spp_ || !(is_variance || tile.variance == kUnknown))
      return fail("a tile with an invalid pilot");
    tile.spp = std::uint32_t(spp);
    pilots_missing_ += tile.has_pilot ? 0 : 1;
  }
  for (const Tile& tile : tiles_)
    if ((tile.spp > 0) != is_made()) return fail("samples that are shared out in part");
  return {};
}

}  // namespace penumbra
