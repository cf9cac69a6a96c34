// The name and the largest size of a work unit: one tile of one image for one pass of samples.
#pragma once

#include <compare>
#include <cstdint>

namespace penumbra {

/// Pixels along a side of a unit: what fits one message between worker and scheduler.
constexpr int kMaxTile = 2048;

/// Ordered as units are issued: image by image, and within an image pass by pass.
struct UnitId {
  std::uint32_t image = 0;  ///< index within the run; a single render has image 0 only
  std::uint32_t pass = 0;
  std::uint32_t tile = 0;

  friend auto operator<=>(const UnitId&, const UnitId&) = default;
};

/// A connected worker; numbers are never used again, so a worker that comes back is another one.
using WorkerId = std::uint32_t;

}  // namespace penumbra
