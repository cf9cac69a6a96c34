// The ID and the largest size of a work unit: one tile in one pass of samples, of one phase of a job.
#pragma once

#include <compare>
#include <cstdint>

namespace penumbra {

/// The largest width and height of a unit in pixels, so that it fits one message between worker and
/// scheduler.
constexpr int kMaxTile = 2048;

/// The ID of a job of a scheduler. IDs begin at 1 and are never reused.
using JobId = std::uint32_t;

/// Ordered as the units of a job are issued: by phase, then by pass.
struct UnitId {
  JobId job = 0;
  std::uint32_t phase = 0;  ///< an image has one phase, 0
  std::uint32_t pass = 0;
  std::uint32_t tile = 0;

  friend auto operator<=>(const UnitId&, const UnitId&) = default;
};

/// The ID of a connected worker. IDs are never reused: a worker that reconnects gets a new one.
using WorkerId = std::uint32_t;

}  // namespace penumbra
