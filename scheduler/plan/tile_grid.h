// The work units of one image: its tiles, row by row, and its passes of samples.
#pragma once

#include <cstdint>

#include "worker/device.h"
#include "worker/work_unit.h"

namespace penumbra {

/// Tiles start at the rectangle's upper left corner. Those at the right and lower edge may be smaller, and so
/// may the last pass.
class TileGrid {
 public:
  TileGrid() = default;
  /// The film rectangle [x, x+width) x [y, y+height), in pixels, all sizes at least 1.
  TileGrid(int x, int y, int width, int height, int tile, std::uint32_t spp, std::uint32_t samples_per_pass);

  [[nodiscard]] std::uint32_t spp() const { return spp_; }
  [[nodiscard]] std::uint32_t samples_per_pass() const { return samples_per_pass_; }
  [[nodiscard]] std::uint32_t tiles() const { return across_ * down_; }
  [[nodiscard]] std::uint32_t passes() const { return passes_; }
  /// The number of samples per pixel in the first `passes` passes.
  [[nodiscard]] std::uint64_t samples_of_pixel(std::uint32_t passes) const;
  /// The number of samples over all pixels in the first `passes` passes.
  [[nodiscard]] std::uint64_t samples(std::uint32_t passes) const;
  [[nodiscard]] std::uint64_t pixels(std::uint32_t tile) const;
  /// The number of samples over all pixels of one tile in its first `passes` passes.
  [[nodiscard]] std::uint64_t samples_of_tile(std::uint32_t tile, std::uint32_t passes) const;
  /// The work unit of `tile` < tiles() and `pass` < passes().
  [[nodiscard]] RenderUnit unit(std::uint32_t tile, std::uint32_t pass) const;

 private:
  int x_ = 0, y_ = 0, width_ = 0, height_ = 0, tile_ = 1;
  std::uint32_t spp_ = 0, samples_per_pass_ = 1;
  std::uint32_t across_ = 0, down_ = 0, passes_ = 0;
};

}  // namespace penumbra
