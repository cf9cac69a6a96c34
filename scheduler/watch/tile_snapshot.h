// One tile as watchers see it.
#pragma once

#include <cstdint>
#include <vector>

namespace penumbra {

/// Means over all samples that are merged so far: a later snapshot of a tile replaces an earlier one. Pixels
/// row by row from the tile's corner.
struct TileSnapshot {
  std::uint32_t view = 0;  ///< number of the camera view that it belongs to; 0 is the scene's own
  int x = 0, y = 0;        ///< film pixel of its corner
  int width = 0, height = 0;
  std::uint32_t samples = 0;          ///< of each pixel
  std::uint32_t worker = 0;           ///< that rendered the last of them
  std::vector<float> radiance;        ///< linear Rec. 709, three a pixel
  std::vector<float> difference;      ///< where polygon lights have a closed form G: <H - alpha W>, what the
                                      ///< light samples with shadows (H) and without (W) add to alpha G,
                                      ///< three a pixel; else empty
  std::vector<float> standard_error;  ///< of the mean radiance, root mean square of its channels, one a
                                      ///< pixel; NaN below two samples

  /// Of the memory that it takes.
  static constexpr std::size_t bytes_per_pixel(bool hybrid) {
    return (3 + 1 + (hybrid ? 3 : 0)) * sizeof(float);
  }
  [[nodiscard]] std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
};

}  // namespace penumbra
