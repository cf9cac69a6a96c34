#include "scheduler/watch/render_feed.h"

#include <cmath>
#include <limits>

#include "kernels/features.h"
#include "kernels/host/device_scene_tables.h"

namespace penumbra {
namespace {

// A tile of 64 x 64 pixels takes about 50 microseconds.
constexpr int kTilesAtOnce = 16;

float standard_error(const PixelStatistics& pixel) {
  if (pixel.count < 2) return std::numeric_limits<float>::quiet_NaN();
  const double n = double(pixel.count);
  return float(std::sqrt((pixel.m2[0] + pixel.m2[1] + pixel.m2[2]) / (3 * n * (n - 1))));
}

}  // namespace

bool is_hybrid(const DeviceScene& scene) {
  const SceneHeader& h = scene.header;
  const std::uint64_t needed = FEATURE_POLYGONS | FEATURE_LAYERS;
  if ((h.features & needed) != needed || (h.features & FEATURE_CAMERA) != 0u ||
      h.integrator.kind != INTEGRATOR_DIRECT || h.integrator.estimator != ESTIMATOR_ALPHA ||
      h.integrator.emitter_samples == 0)
    return false;
  int parts = 0;
  for (const Polygon& polygon : table<Polygon>(scene, h.tables.polygons)) parts += polygon.light_count;
  return parts == h.tables.lights.count;
}

TileSnapshot snapshot_of(const FilmAccumulator& film, const RenderUnit& area, bool hybrid, float alpha) {
  TileSnapshot tile;
  tile.x = area.x;
  tile.y = area.y;
  tile.width = area.width;
  tile.height = area.height;
  tile.samples = std::uint32_t(film.at(area.x, area.y).count);
  tile.radiance.reserve(3 * tile.pixels());
  tile.standard_error.reserve(tile.pixels());
  if (hybrid) tile.difference.reserve(3 * tile.pixels());
  for (int y = area.y; y < area.y + area.height; ++y) {
    for (int x = area.x; x < area.x + area.width; ++x) {
      const PixelStatistics& pixel = film.at(x, y);
      for (const double mean : pixel.mean) tile.radiance.push_back(float(mean));
      tile.standard_error.push_back(standard_error(pixel));
      // The film's layer is the difference to the closed form itself, and its values must remain exactly
      // those written to files.
      for (int c = 0; hybrid && c < 3; ++c) {
        const double difference = film.layer(x, y, LAYER_DIFFERENCE, c);
        const double less =
            alpha == 1 ? difference : difference + (1 - double(alpha)) * film.layer(x, y, LAYER_ANALYTIC, c);
        tile.difference.push_back(float(less));
      }
    }
  }
  return tile;
}

void RenderFeed::begin_view(const WatchView& view) {
  view_ = view;
  changed_.clear();
}

void RenderFeed::tile_changed(std::uint32_t tile, WorkerId worker) {
  changed_.insert(tile);
  last_worker_[tile] = worker;
}

void RenderFeed::publish(const FilmAccumulator& film, bool all) {
  if (!board_.is_watched()) {
    changed_.clear();
    return;
  }
  if (board_.take_request_for_all_tiles()) {
    for (std::uint32_t tile = 0; tile < grid_.tiles(); ++tile) {
      const RenderUnit area = grid_.unit(tile, 0);
      if (film.at(area.x, area.y).count > 0) changed_.insert(tile);
    }
  }
  for (int shown = 0; !changed_.empty() && (all || shown < kTilesAtOnce); ++shown) {
    const std::uint32_t tile = *changed_.begin();
    changed_.erase(changed_.begin());
    const RenderUnit area = grid_.unit(tile, 0);
    if (film.at(area.x, area.y).count == 0) continue;  // its first pass is not merged yet
    TileSnapshot snapshot = snapshot_of(film, area, hybrid_, view_.view.adjustable.alpha);
    snapshot.view = view_.number;
    snapshot.worker = last_worker_[tile];
    board_.show_tile(tile, std::move(snapshot));
  }
}

}  // namespace penumbra
