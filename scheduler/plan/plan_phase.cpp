// The units of a phase of a job, and the order in which they are issued.
#include <algorithm>

#include "scheduler/plan/plan.h"

namespace penumbra {

Plan::Phase::Phase(const PhaseUnits& units)
    : tiles(units.tiles),
      passes(units.passes),
      by_tile(units.passes_at_first != kAllPasses),
      at_once(units.passes_at_once),
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
  queued = next;
  queue_tiles();
}

std::uint64_t Plan::Phase::units() const {
  std::uint64_t all = 0;
  for (std::uint32_t tile = 0; tile < tiles; ++tile) all += end(tile);
  return all;
}

std::uint32_t Plan::Phase::issued_end(std::uint32_t tile) const {
  std::uint32_t end = queued[tile];
  while (end > next[tile] && fresh.contains({end - 1, tile})) --end;
  return end;
}

void Plan::Phase::queue_tiles() {
  for (std::uint32_t tile = 0; tile < tiles; ++tile) queue(tile);
}

/// After a change of the tile's `next` or end: completes `fresh`.
void Plan::Phase::queue(std::uint32_t tile) {
  const auto most = std::uint32_t(std::min<std::uint64_t>(end(tile), std::uint64_t(next[tile]) + at_once));
  while (queued[tile] < most) fresh.emplace(queued[tile]++, tile);
  while (queued[tile] > end(tile)) fresh.erase({--queued[tile], tile});
}

/// The unit is issued.
void Plan::Phase::take(std::uint32_t pass, std::uint32_t tile) {
  fresh.erase({pass, tile});
  while (next[tile] < queued[tile] && !fresh.contains({next[tile], tile})) ++next[tile];
  queue(tile);
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
