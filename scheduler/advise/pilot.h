// A pilot render: few samples of a few tiles of the film, in batches that are independent of each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/block/path_state.h"
#include "kernels/host/device_scene.h"
#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra {

constexpr int kPilotBatches = 4;
constexpr int kPilotSamples = 8;  ///< per pixel and batch
constexpr int kPilotSide = 8;     ///< of a tile in pixels
constexpr int kPilotTiles = 64;   ///< by default at most

struct PilotTile {
  int x = 0, y = 0, width = 0, height = 0;  ///< in film pixels
};

/// Tiles of the film's crop window, one at a random place of each cell of a grid; all of the window if that
/// is small. The same for the same window. At most `most`.
std::vector<PilotTile> pilot_tiles(const Film& film, int most = kPilotTiles);

struct Pilot {
  /// Of each batch, mean radiance [3 * pixel + channel]; pixels are those of the tiles, one after the other,
  /// row by row.
  std::vector<std::vector<float>> means;
  /// The variance of a batch's mean as its own samples show it, for independent samples; mean over batches.
  std::vector<double> within;
  TracedRays traced{};        ///< of all batches
  std::uint64_t samples = 0;  ///< of all batches and pixels
};

/// Renders the tiles with `threads` threads. The result does not depend on them. A scene with photons gets a
/// map for each batch. Errors: those of devices.
Expected<Pilot> render_pilot(const DeviceScene& scene, std::span<const PilotTile> tiles, int threads);

}  // namespace penumbra
