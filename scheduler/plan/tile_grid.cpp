#include "scheduler/plan/tile_grid.h"

#include <algorithm>

namespace penumbra {

TileGrid::TileGrid(int x, int y, int width, int height, int tile, std::uint32_t spp,
                   std::uint32_t samples_per_pass)
    : x_(x),
      y_(y),
      width_(width),
      height_(height),
      tile_(tile),
      spp_(spp),
      samples_per_pass_(samples_per_pass),
      across_(std::uint32_t((std::int64_t(width) + tile - 1) / tile)),
      down_(std::uint32_t((std::int64_t(height) + tile - 1) / tile)),
      passes_(std::uint32_t((std::uint64_t(spp) + samples_per_pass - 1) / samples_per_pass)) {}

std::uint64_t TileGrid::samples_of_pixel(std::uint32_t passes) const {
  return std::min(std::uint64_t(spp_), std::uint64_t(passes) * samples_per_pass_);
}

std::uint64_t TileGrid::samples(std::uint32_t passes) const {
  return std::uint64_t(width_) * std::uint64_t(height_) * samples_of_pixel(passes);
}

std::uint64_t TileGrid::pixels(std::uint32_t tile) const {
  const RenderUnit area = unit(tile, 0);
  return std::uint64_t(area.width) * std::uint64_t(area.height);
}

std::uint64_t TileGrid::samples_of_tile(std::uint32_t tile, std::uint32_t passes) const {
  return pixels(tile) * samples_of_pixel(passes);
}

RenderUnit TileGrid::unit(std::uint32_t tile, std::uint32_t pass) const {
  const int left = int(tile % across_) * tile_;
  const int top = int(tile / across_) * tile_;
  const std::uint32_t first_sample = pass * samples_per_pass_;
  return {.x = x_ + left,
          .y = y_ + top,
          .width = std::min(tile_, width_ - left),
          .height = std::min(tile_, height_ - top),
          .first_sample = first_sample,
          .sample_count = std::min(samples_per_pass_, spp_ - first_sample)};
}

}  // namespace penumbra
