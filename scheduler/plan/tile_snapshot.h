// The state of one tile for viewers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace penumbra {

/// A further layer of a tile: the mean of a layer of kernels/film_layers.h by its name, or kMatteLayer.
struct TileLayer {
  std::string name;
  std::vector<float> values;  ///< one to three per pixel
};

/// For each pixel the matte (Cryptomatte) that most of its samples hit, from 1 on; 0: none.
constexpr const char* kMatteLayer = "matte";

/// Means over all samples merged so far. A later snapshot of a tile replaces an earlier one. Pixels are
/// stored row by row from the tile's corner.
struct TileSnapshot {
  std::uint32_t view = 0;  ///< number of the camera view; 0 is the scene's own
  int x = 0, y = 0;        ///< film coordinates of its corner
  int width = 0, height = 0;
  std::uint32_t samples = 0;    ///< per pixel
  std::uint32_t worker = 0;     ///< the worker that rendered the last of them
  std::vector<float> radiance;  ///< linear Rec. 709, three values per pixel
  /// If polygon lights have a closed form G: the mean of H - alpha W, which light samples with shadows (H)
  /// and without (W) add to alpha G; three values per pixel; else empty.
  std::vector<float> difference;
  /// Of the mean radiance: root mean square over its channels, one value per pixel; NaN for fewer than two
  /// samples.
  std::vector<float> standard_error;
  std::vector<TileLayer> layers = {};  ///< those that viewers want

  /// Bytes of memory per pixel, without further layers.
  static constexpr std::size_t bytes_per_pixel(bool hybrid) {
    return (3 + 1 + (hybrid ? 3 : 0)) * sizeof(float);
  }
  [[nodiscard]] std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
};

}  // namespace penumbra
