// The name and the largest size of a work unit: one tile of one job's phase for one pass of samples.
#pragma once

#include <compare>
#include <cstdint>

namespace penumbra {

/// Pixels along a side of a unit: what fits one message between worker and scheduler.
constexpr int kMaxTile = 2048;

/// A job of a scheduler; numbers begin at 1 and are never used again.
using JobId = std::uint32_t;

/// Ordered as units of a job are issued: phase by phase, and within a phase pass by pass.
struct UnitId {
  JobId job = 0;
  std::uint32_t phase = 0;  ///< what of the job; an image has one phase, 0
  std::uint32_t pass = 0;
  std::uint32_t tile = 0;

  friend auto operator<=>(const UnitId&, const UnitId&) = default;
};

/// A connected worker; numbers are never used again, so a worker that comes back is another one.
using WorkerId = std::uint32_t;

}  // namespace penumbra
