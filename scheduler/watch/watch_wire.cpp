#include "scheduler/watch/watch_wire.h"

#include <fmt/format.h>
#include <cmath>

#include <cstring>

#include "kernels/host/text.h"
#include "worker/protocol/text.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

void put_floats(const std::vector<float>& values, std::string& bytes) {
  bytes.assign(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

std::vector<float> floats_of(const std::string& bytes) {
  std::vector<float> values(bytes.size() / sizeof(float));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

void put(const WatchView& view, wire::WatchEvent& event) {
  event.mutable_view()->set_number(view.number);
  encode(view.view, *event.mutable_view()->mutable_view());
}

void put(const std::string& text, wire::WatchEvent& event) {
  event.set_message(wire_text(text, kLongestText));
}

void put(const std::shared_ptr<const WatchProgress>& progress, wire::WatchEvent& event) {
  wire::Progress& message = *event.mutable_progress();
  message.set_view(progress->view);
  message.set_samples_done(progress->samples_done);
  message.set_samples_wanted(progress->samples_wanted);
  message.set_spp_done(progress->spp_done);
  message.set_spp_wanted(progress->spp_wanted);
  message.set_elapsed_seconds(progress->elapsed_seconds);
  message.set_relative_error(progress->relative_error);
  message.set_finished(progress->finished);
  message.set_ended(progress->ended);
  for (const WatchedWorker& worker : progress->workers) {
    wire::WorkerState& state = *message.add_workers();
    state.set_number(worker.number);
    state.set_name(wire_text(worker.name, kLongestText));
    state.set_device(wire_text(worker.device, kLongestName));
    state.set_units(worker.units);
    state.set_x(worker.x);
    state.set_y(worker.y);
    state.set_width(worker.width);
    state.set_height(worker.height);
  }
}

void put(const std::shared_ptr<const TileSnapshot>& tile, wire::WatchEvent& event) {
  wire::TileState& message = *event.mutable_tile();
  message.set_view(tile->view);
  message.set_x(tile->x);
  message.set_y(tile->y);
  message.set_width(tile->width);
  message.set_height(tile->height);
  message.set_samples(tile->samples);
  message.set_worker(tile->worker);
  put_floats(tile->radiance, *message.mutable_radiance());
  put_floats(tile->difference, *message.mutable_difference());
  put_floats(tile->standard_error, *message.mutable_standard_error());
  for (const TileLayer& layer : tile->layers) {
    wire::TileLayer& sent = *message.add_layers();
    sent.set_name(layer.name);
    put_floats(layer.values, *sent.mutable_values());
  }
}

/// Whether [x, x + width) x [y, y + height) is not empty and inside the film.
bool is_on_film(int x, int y, int width, int height, int film_width, int film_height) {
  return film_width > 0 && film_height > 0 && width > 0 && height > 0 && x >= 0 && y >= 0 &&
         x <= film_width - width && y <= film_height - height;
}

}  // namespace

wire::WatchEvent encode(const WatchedJob& job) {
  wire::WatchEvent event;
  wire::WatchedJob& message = *event.mutable_job();
  message.set_title(wire_text(job.title, kLongestText));
  message.set_integrator(wire_text(job.integrator, kLongestName));
  message.set_film_width(job.film_width);
  message.set_film_height(job.film_height);
  message.set_x(job.x);
  message.set_y(job.y);
  message.set_width(job.width);
  message.set_height(job.height);
  message.set_spp(job.spp);
  message.set_scene(job.scene_hash);
  for (const double coordinate : job.center) message.add_center(coordinate);
  message.set_interactive(job.interactive);
  message.set_hybrid(job.hybrid);
  message.set_id(job.id);
  message.set_command(wire_text(job.command, kLongestText));
  message.set_scene_spp(job.scene_spp);
  for (const std::string& layer : job.layers) message.add_layers(layer);
  return event;
}

Expected<WatchedJob> decode(const wire::WatchedJob& message) {
  WatchedJob job{.id = message.id(),
                 .title = wire_text(message.title(), kLongestText),
                 .integrator = wire_text(message.integrator(), kLongestName),
                 .film_width = message.film_width(),
                 .film_height = message.film_height(),
                 .x = message.x(),
                 .y = message.y(),
                 .width = message.width(),
                 .height = message.height(),
                 .spp = message.spp(),
                 .scene_hash = message.scene(),
                 .interactive = message.interactive(),
                 .hybrid = message.hybrid(),
                 .command = wire_text(message.command(), kLongestText),
                 .scene_spp = message.scene_spp(),
                 .layers = {}};
  for (const std::string& layer : message.layers()) job.layers.push_back(wire_text(layer, kLongestName));
  if (!is_on_film(job.x, job.y, job.width, job.height, job.film_width, job.film_height))
    return fail(fmt::format("the scheduler describes {} x {} pixels at ({}, {}) of a film of {} x {}",
                            job.width, job.height, job.x, job.y, job.film_width, job.film_height));
  if (message.center_size() != 3) return fail("the scheduler describes a scene without a centre");
  for (int axis = 0; axis < 3; ++axis) {
    job.center[axis] = message.center(axis);
    if (!std::isfinite(job.center[axis]))
      return fail("the scheduler describes a scene whose centre is not finite");
  }
  return job;
}

wire::WatchEvent encode(const WatchItem& item) {
  wire::WatchEvent event;
  std::visit([&](const auto& content) { put(content, event); }, item);
  return event;
}

Expected<WatchView> decode(const wire::NumberedView& message) {
  const Expected<View> view = decode(message.view());
  if (!view) return std::unexpected(view.error());
  return WatchView{message.number(), *view};
}

WatchProgress decode(const wire::Progress& message) {
  WatchProgress progress{.view = message.view(),
                         .samples_done = message.samples_done(),
                         .samples_wanted = message.samples_wanted(),
                         .spp_done = message.spp_done(),
                         .spp_wanted = message.spp_wanted(),
                         .elapsed_seconds = message.elapsed_seconds(),
                         .relative_error = message.relative_error(),
                         .finished = message.finished(),
                         .ended = message.ended(),
                         .workers = {}};
  for (const wire::WorkerState& worker : message.workers())
    progress.workers.push_back({.number = worker.number(),
                                .name = wire_text(worker.name(), kLongestName),
                                .device = wire_text(worker.device(), kLongestName),
                                .units = worker.units(),
                                .x = worker.x(),
                                .y = worker.y(),
                                .width = worker.width(),
                                .height = worker.height()});
  return progress;
}

Expected<TileSnapshot> decode(const wire::TileState& message, const WatchedJob& job) {
  TileSnapshot tile{.view = message.view(),
                    .x = message.x(),
                    .y = message.y(),
                    .width = message.width(),
                    .height = message.height(),
                    .samples = message.samples(),
                    .worker = message.worker(),
                    .radiance = floats_of(message.radiance()),
                    .difference = floats_of(message.difference()),
                    .standard_error = floats_of(message.standard_error())};
  const auto is_whole = [](const std::string& bytes) { return bytes.size() % sizeof(float) == 0; };
  if (!is_whole(message.radiance()) || !is_whole(message.difference()) ||
      !is_whole(message.standard_error()) ||
      !is_on_film(tile.x, tile.y, tile.width, tile.height, job.film_width, job.film_height) ||
      tile.radiance.size() != 3 * tile.pixels() || tile.standard_error.size() != tile.pixels() ||
      tile.difference.size() != (job.hybrid ? 3 * tile.pixels() : 0))
    return fail(fmt::format("a tile of {} x {} pixels at ({}, {}) that is not one of this render", tile.width,
                            tile.height, tile.x, tile.y));
  for (const wire::TileLayer& layer : message.layers()) {
    TileLayer values{wire_text(layer.name(), kLongestName), floats_of(layer.values())};
    const std::size_t planes = values.values.size() / tile.pixels();
    if (!is_whole(layer.values()) || planes < 1 || planes > 3 ||
        values.values.size() != planes * tile.pixels())
      return fail(fmt::format("a tile's layer '{}' with {} for {}", values.name,
                              counted(layer.values().size(), "byte"), counted(tile.pixels(), "pixel")));
    tile.layers.push_back(std::move(values));
  }
  return tile;
}

}  // namespace penumbra
