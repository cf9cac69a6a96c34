// Publishes the film of a render to its watchers.
#pragma once

#include <cstdint>
#include <set>

#include "kernels/host/device_scene.h"
#include "scheduler/plan/merge.h"
#include "scheduler/plan/tile_grid.h"
#include "scheduler/watch/watch_board.h"

namespace penumbra {

/// Whether viewers can draw the closed form themselves, and tiles hold the difference to it: direct lighting
/// from polygon lights only, seen by a pinhole, with feature layers and a given alpha.
bool is_hybrid(const DeviceScene& scene);

/// A tile's means over what is merged of it. With `hybrid` the difference to alpha times the closed form.
TileSnapshot snapshot_of(const FilmAccumulator& film, const RenderUnit& area, bool hybrid, float alpha);

/// Tracks which tiles have changed and shows a few of them at a time. So the render's own thread spends
/// little time on it, however fast tiles change and however many viewers there are.
class RenderFeed {
 public:
  RenderFeed(WatchBoard& board, const TileGrid& grid, bool hybrid)
      : board_(board), grid_(grid), hybrid_(hybrid), last_worker_(grid.tiles()) {}

  /// Forgets what has changed: another view begins.
  void begin_view(const WatchView& view);
  /// A result of this worker went into the tile.
  void tile_changed(std::uint32_t tile, WorkerId worker);
  /// Shows changed tiles: all of them, or a few. Does nothing while there are no viewers.
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
