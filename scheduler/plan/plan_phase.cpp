// The units of a phase of a job, and the order in which they are issued.
#include <algorithm>
#include <functional>

#include "scheduler/plan/plan.h"

namespace penumbra {

Plan::Phase::Phase(const PhaseUnits& units)
    : tiles(units.tiles),
      passes(units.passes),
      by_tile(units.passes_at_first != kAllPasses),
      next(units.tiles),
      limit(units.tiles, units.passes_at_first) {
  const std::size_t known = std::min(units.merged.size(), next.size());
  std::copy_n(units.merged.begin(), known, next.begin());
  for (std::uint32_t tile = 0; tile < tiles; ++tile) {
    next[tile] = std::min(next[tile], passes);
    if (const auto& most = units.units_at_most) {
      const std::uint64_t own = *most / tiles + (tile < *most % tiles ? 1 : 0);
      limit[tile] = std::uint32_t(std::min<std::uint64_t>(limit[tile], own));
    }
    limit[tile] = std::max(limit[tile], next[tile]);
    left += end(tile) - next[tile];
  }
  queue_tiles();
}

std::uint64_t Plan::Phase::units() const {
  std::uint64_t all = 0;
  for (std::uint32_t tile = 0; tile < tiles; ++tile) all += end(tile);
  return all;
}

void Plan::Phase::queue_tiles() {
  fresh.clear();
  for (std::uint32_t tile = 0; tile < tiles; ++tile)
    if (next[tile] < end(tile)) fresh.push_back(std::uint64_t(next[tile]) << 32 | tile);
  std::ranges::make_heap(fresh, std::greater());
}

/// Adds a tile that is not in the heap.
void Plan::Phase::queue(std::uint32_t tile) {
  if (next[tile] >= end(tile)) return;
  fresh.push_back(std::uint64_t(next[tile]) << 32 | tile);
  std::ranges::push_heap(fresh, std::greater());
}

std::optional<std::pair<std::uint32_t, std::uint32_t>> Plan::Phase::take() {
  if (fresh.empty()) return {};
  std::ranges::pop_heap(fresh, std::greater());
  const auto tile = std::uint32_t(fresh.back());
  fresh.pop_back();
  const std::uint32_t pass = next[tile]++;
  queue(tile);
  return std::pair(pass, tile);
}

void Plan::Job::begin() {
  phases.clear();
  for (const PhaseUnits& units : as_added) phases.emplace_back(units);
  phase = 0;
  waits = false;
  units_left = 0;
  counts = {};
  for (const Phase& p : phases) {
    units_left += p.left;
    counts.done += p.units() - p.left;
  }
  set_aside.clear();
  idle_since.reset();
}

}  // namespace penumbra
