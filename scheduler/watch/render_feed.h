// Publishes the film of a render to its viewers.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scheduler/plan/merge.h"
#include "scheduler/plan/tile_grid.h"
#include "scheduler/watch/watch_board.h"

namespace penumbra {

/// Whether viewers can draw the closed form of polygon lights themselves, and tiles contain the difference to
/// it. This requires direct illumination only by polygon lights, a pinhole camera, feature layers and a fixed
/// alpha.
bool is_hybrid(const DeviceScene& scene);

/// The names of the further layers that tiles of such a film can contain: those that images show, without the
/// closed form and its difference, and kMatteLayer.
std::vector<std::string> watchable_layers(const FilmLayers& layers);

/// The means of a tile over all merged samples. With `hybrid` including the difference to alpha times the
/// closed form. `layers`: names of watchable_layers.
TileSnapshot snapshot_of(const FilmAccumulator& film, const RenderUnit& area, bool hybrid, float alpha,
                         const std::set<std::string>& layers = {});

/// Tracks which tiles have changed and publishes a few of them at a time. So it takes little time of the
/// render's own thread, however fast tiles change and however many viewers there are.
class RenderFeed {
 public:
  RenderFeed(WatchBoard& board, const TileGrid& grid, bool hybrid)
      : board_(board), grid_(grid), hybrid_(hybrid), last_worker_(grid.tiles()) {}

  /// Another view begins: forgets which tiles have changed.
  void begin_view(const WatchView& view);
  /// A result of this worker was merged into the tile.
  void tile_changed(std::uint32_t tile, WorkerId worker);
  /// Publishes all changed tiles, or a few of them. Does nothing while there are no viewers.
  void publish(const FilmAccumulator& film, bool all);

 private:
  WatchBoard& board_;
  TileGrid grid_;
  bool hybrid_;
  WatchView view_;
  std::set<std::uint32_t> changed_;
  std::vector<WorkerId> last_worker_;
};

}  // namespace penumbra
