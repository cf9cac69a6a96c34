// The options of a render that determine its tiles, passes and samples.
#pragma once

#include <cstdint>
#include <optional>

namespace penumbra {

/// Defaults of `--pass` and `--tile`. With progressive photon mapping the samples of a pass share a photon
/// map: the error falls with the number of maps, so a pass has one sample, and a tile has more pixels
/// instead.
constexpr std::uint32_t kDefaultPass = 16, kPassWithMaps = 1;
constexpr int kDefaultTile = 64, kTileWithMaps = 256;

/// The image depends on all of them, on `tile` only if depends_on_tiles(). Adaptive sampling excludes a
/// target error and both stops.
struct PlanOptions {
  std::optional<std::uint32_t> stop_after = {};        ///< only so many of the samples per pixel
  std::uint32_t samples_per_pass = kDefaultPass;       ///< see FilmAccumulator
  std::optional<double> target_error = {};             ///< relative, of each tile; see AdaptiveTile
  bool adaptive = false;                               ///< see SampleAllocation
  std::optional<std::uint64_t> stop_after_units = {};  ///< only so many units, in issue order
  int tile = kDefaultTile;                             ///< side in pixels

  [[nodiscard]] bool depends_on_tiles() const { return target_error || adaptive || stop_after_units; }
};

}  // namespace penumbra
