#include "scheduler/watch/render_feed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "kernels/features.h"
#include "kernels/host/device_scene.h"

namespace penumbra {
namespace {

// A tile of 64 x 64 pixels takes about 50 microseconds.
constexpr int kTilesAtOnce = 16;

float standard_error(const PixelStatistics& pixel) {
  if (pixel.count < 2) return std::numeric_limits<float>::quiet_NaN();
  const double n = double(pixel.count);
  return float(std::sqrt((pixel.m2[0] + pixel.m2[1] + pixel.m2[2]) / (3 * n * (n - 1))));
}

/// Layers that other layers or the picture itself contain, or whose planes are not means.
constexpr std::array kNotWatched{LAYER_ANALYTIC,        LAYER_DIFFERENCE,    LAYER_SHADOWED,
                                 LAYER_HALF_A,          LAYER_HALF_B,        LAYER_ALBEDO_VARIANCE,
                                 LAYER_NORMAL_VARIANCE, LAYER_DEPTH_VARIANCE};

bool is_watchable(int layer) {
  return !kFilmLayers[layer].channels.empty() && !kFilmLayers[layer].name.empty() &&
         std::ranges::find(kNotWatched, layer) == kNotWatched.end();
}

std::vector<float> layer_values(const FilmAccumulator& film, const RenderUnit& area, int layer) {
  std::vector<float> values;
  for (int y = area.y; y < area.y + area.height; ++y)
    for (int x = area.x; x < area.x + area.width; ++x)
      for (int plane = 0; plane < kFilmLayers[layer].planes; ++plane)
        values.push_back(float(film.layer(x, y, layer, plane)));
  return values;
}

std::vector<float> heaviest_mattes(const FilmAccumulator& film, const RenderUnit& area) {
  std::vector<float> values;
  for (int y = area.y; y < area.y + area.height; ++y) {
    for (int x = area.x; x < area.x + area.width; ++x) {
      const auto mattes = film.mattes(x, y);
      const auto most = std::ranges::max_element(mattes, {}, &MatteWeight::weight);
      values.push_back(most == mattes.end() ? 0.0f : float(most->matte));
    }
  }
  return values;
}

}  // namespace

std::vector<std::string> watchable_layers(const FilmLayers& layers) {
  std::vector<std::string> names;
  for (int layer = 0; layer < FILM_LAYERS; ++layer)
    if (layers.has(layer) && is_watchable(layer)) names.emplace_back(kFilmLayers[layer].name);
  if (layers.mattes() > 0) names.emplace_back(kMatteLayer);
  return names;
}

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

TileSnapshot snapshot_of(const FilmAccumulator& film, const RenderUnit& area, bool hybrid, float alpha,
                         const std::set<std::string>& layers) {
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
  for (int layer = 0; layer < FILM_LAYERS; ++layer) {
    const std::string name(kFilmLayers[layer].name);
    if (film.layers().has(layer) && is_watchable(layer) && layers.contains(name))
      tile.layers.push_back({name, layer_values(film, area, layer)});
  }
  if (film.layers().mattes() > 0 && layers.contains(kMatteLayer))
    tile.layers.push_back({kMatteLayer, heaviest_mattes(film, area)});
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
  const std::set<std::string> layers = board_.wanted_layers();
  for (int shown = 0; !changed_.empty() && (all || shown < kTilesAtOnce); ++shown) {
    const std::uint32_t tile = *changed_.begin();
    changed_.erase(changed_.begin());
    const RenderUnit area = grid_.unit(tile, 0);
    if (film.at(area.x, area.y).count == 0) continue;  // its first pass is not merged yet
    TileSnapshot snapshot = snapshot_of(film, area, hybrid_, view_.view.adjustable.alpha, layers);
    snapshot.view = view_.number;
    snapshot.worker = last_worker_[tile];
    board_.show_tile(tile, std::move(snapshot));
  }
}

}  // namespace penumbra
