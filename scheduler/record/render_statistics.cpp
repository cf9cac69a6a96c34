#include "scheduler/record/render_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "kernels/host/process.h"
#include "kernels/host/text.h"
#include "scenes/number.h"
#include "scheduler/files/json_number.h"
#include "scheduler/record/film_image.h"
#include "scheduler/record/flagged_text.h"
#include "scheduler/record/inventory.h"
#include "scheduler/record/version.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

/// Null if it has no value. Flags on which pixels depend are texts, as in records.
Json option_json(const RenderOption& option, const RenderRecord& record) {
  const std::vector<std::string> values = option.print(record);
  if (option.kind == OptionKind::kList) return values;
  if (option.kind == OptionKind::kFlag && option.effect != OptionEffect::kPixels) return !values.empty();
  if (values.empty()) return nullptr;
  if (option.recorded_as_text) return values.front();
  if (option.kind == OptionKind::kNumber) return *parse_number(values.front());
  if (option.kind == OptionKind::kInteger || option.kind == OptionKind::kCount)
    return *parse_integer(values.front());
  return values.front();
}

Json settings_json(const RenderStatistics& statistics) {
  Json settings;
  for (const auto& [name, value] : record_entries(statistics.record)) {
    std::visit([&, &key = name](const auto& v) { settings[key] = v; }, value);
  }
  settings["spp"] = statistics.record.sampler.spp;
  settings["seed"] = statistics.record.sampler.seed;
  for (const RenderOption& option : all_render_options())
    if (option.is_sent()) settings[option.record_name()] = option_json(option, statistics.record);
  settings["workers"] = statistics.workers;
  return settings;
}

/// The number of invalid samples of a kind, and the first of them.
Json flagged_json(int kind, const FlaggedSamples& samples, const RenderStatistics& statistics) {
  if (samples.count == 0) return {{"count", 0}, {"first", nullptr}};
  Json first{{"x", samples.x}, {"y", samples.y}, {"sample", samples.sample}};
  if (kind == BAD_BOUNDARY) {
    first["shape"] = statistics.contradictory_shape;
  } else {
    first["source"] = source_name(samples.source.where);
    first["step"] = samples.source.step;
  }
  first["repeat"] = repeat_sample_command(samples, statistics.job->reproduce_command);
  return {{"count", samples.count}, {"first", first}};
}

Json samples_json(const RenderStatistics& statistics) {
  const FilmAccumulator& film = statistics.outcome->film;
  const SampleRange range = sample_range(film);
  Json samples{{"total", range.total},
               {"before", statistics.outcome->samples_before},
               {"least_per_pixel", range.least},
               {"most_per_pixel", range.most}};
  const FlaggedByKind flagged = film.flagged();
  for (int kind = 0; kind < BAD_KINDS; ++kind)
    samples[std::string(flagged_name(kind))] = flagged_json(kind, flagged[std::size_t(kind)], statistics);
  samples["pixels_of_infinite_variance"] = pixels_of_infinite_variance(film);
  return samples;
}

/// Means over the image of the closed form of polygon lights, of the reduction by shadows, and of the visible
/// fraction. Null if there is no closed form.
Json polygon_light_json(const FilmAccumulator& film) {
  if (!film.layers().has(LAYER_ANALYTIC)) return nullptr;
  double analytic[3] = {}, difference[3] = {}, visibility = 0;
  const double pixels = double(film.width()) * film.height();
  for (int y = film.y(); y < film.y() + film.height(); ++y)
    for (int x = film.x(); x < film.x() + film.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        analytic[c] += film.layer(x, y, LAYER_ANALYTIC, c) / pixels;
        difference[c] += film.layer(x, y, LAYER_DIFFERENCE, c) / pixels;
      }
      visibility += film.visibility(x, y) / pixels;
    }
  return {{"analytic", analytic}, {"difference", difference}, {"visibility", visibility}};
}

/// The origin of a worker's OpenCL kernels.
Json kernels_json(const std::optional<KernelOrigin>& kernels) {
  if (!kernels) return nullptr;
  return {{"cached", kernels->cached},
          {"compile_seconds", kernels->cached ? 0.0 : kernels->seconds},
          {"cache_seconds", kernels->cached ? kernels->seconds : 0.0},
          {"note", kernels->note.empty() ? Json(nullptr) : Json(kernels->note)}};
}

Json worker_json(const WorkerShare& worker, std::uint64_t all_samples) {
  return {{"name", worker.name},
          {"device", worker.device},
          {"units", worker.units},
          {"samples", worker.samples},
          {"share", all_samples > 0 ? Json(double(worker.samples) / double(all_samples)) : Json(nullptr)},
          {"busy_seconds", worker.busy_seconds},
          {"peak_memory_bytes", worker.peak_memory_bytes},
          {"scene_bytes", {{"fetched", worker.scene.fetched}, {"found", worker.scene.found}}},
          {"kernels", kernels_json(worker.kernels)},
          {"ended", worker.ended.empty() ? Json(nullptr) : Json(worker.ended)}};
}

}  // namespace

Json grouped_json(const std::vector<std::pair<std::string, std::string>>& entries) {
  std::map<std::string, int> occurrences;
  for (const auto& [name, value] : entries) ++occurrences[name];
  Json json = Json::object();
  for (const auto& [name, value] : entries) {
    if (occurrences[name] > 1) {
      json[name].push_back(value);
    } else {
      json[name] = value;
    }
  }
  return json;
}

double samples_per_second(const RenderOutcome& outcome) {
  std::uint64_t samples = 0;
  for (const WorkerShare& worker : outcome.workers) samples += worker.samples;
  const double seconds = outcome.seconds - outcome.seconds_to_ready;
  return seconds > 0 ? double(samples) / seconds : 0.0;
}

/// The reason why the render ended.
std::string_view ended_by(const RenderStatistics& statistics) {
  const RenderOutcome& outcome = *statistics.outcome;
  const RenderJob& job = *statistics.job;
  if (!outcome.complete) return outcome.problems.empty() ? "interrupt" : "failure";
  if (outcome.ended_by_tile && job.request.plan.target_error) return "target_error";
  if (outcome.ended_by_tile || sample_range(outcome.film).least >= statistics.record.sampler.spp)
    return "samples";
  return job.request.time_budget ? "time_budget" : "stop_after";
}

RenderedSamples rendered_samples(const RenderOutcome& outcome) {
  const SampleRange range = sample_range(outcome.film);
  return {.complete = outcome.complete,
          .has_gaps = outcome.units_set_aside > 0 || outcome.shares_missing,
          .least = range.least,
          .most = range.most,
          .ended_by_tile = outcome.ended_by_tile,
          .units_in_order = outcome.units_in_order};
}

std::string_view backends_of(const RenderOutcome& outcome) {
  bool native = false, opencl = false;
  for (const WorkerShare& worker : outcome.workers) {
    if (worker.units == 0) continue;
    (worker.kernels ? opencl : native) = true;
  }
  return native && opencl ? "native, opencl" : opencl ? "opencl" : native ? "native" : "";
}

Json statistics_json(const RenderStatistics& statistics) {
  const RenderJob& job = *statistics.job;
  const RenderOutcome& outcome = *statistics.outcome;
  const bool repeatable = rendered_samples(outcome).repeatable();
  const Json command = repeat_command(statistics.record, true);
  const Film& film = statistics.record.film;
  std::uint64_t worker_samples = 0, worker_memory = 0;
  for (const WorkerShare& worker : outcome.workers) {
    worker_samples += worker.samples;
    worker_memory = std::max(worker_memory, worker.peak_memory_bytes);
  }
  Json workers = Json::array();
  for (const WorkerShare& worker : outcome.workers) workers.push_back(worker_json(worker, worker_samples));
  Json files = Json::array();
  for (const auto& file : statistics.files) files.push_back(file.string());
  const std::string_view end = ended_by(statistics);

  return {
      {"penumbra", kVersion},
      {"complete", outcome.complete && end != "time_budget"},
      {"ended_by", end},
      {"scene", statistics.record.scene.file},
      {"scene_hash", hash_text(statistics.record.scene_hash)},
      {"files", files},
      {"repeat_command", repeatable ? command : Json(nullptr)},
      {"nearest_command", repeatable ? Json(nullptr) : command},
      {"command_line", statistics.command_line},
      {"host", host_name()},
      {"finished", nullptr},
      {"film",
       {{"width", film.width},
        {"height", film.height},
        {"crop", {film.crop_x, film.crop_y, film.crop_x + film.crop_width, film.crop_y + film.crop_height}}}},
      {"settings", settings_json(statistics)},
      {"auto", statistics.choice.empty() ? Json(nullptr) : Json(statistics.choice)},
      {"samples", samples_json(statistics)},
      {"relative_error", json_number(outcome.film.relative_error())},
      {"polygon_lights", polygon_light_json(outcome.film)},
      {"film_hash", hash_text(outcome.film.hash())},
      {"seconds",
       {{"build", statistics.build_seconds},
        {"transfer", outcome.seconds_to_ready},
        {"to_first_tile", outcome.seconds_to_first_tile},
        {"render", outcome.seconds},
        {"before", outcome.seconds_before},
        {"write", nullptr}}},
      {"samples_per_second", samples_per_second(outcome)},
      {"passes", {{"finished", outcome.passes_finished}, {"asked_for", outcome.passes_total}}},
      {"units",
       {{"done", outcome.units_done},
        {"duplicated", outcome.units_duplicated},
        {"requeued", outcome.units_requeued},
        {"verified", outcome.units_verified}}},
      {"workers", workers},
      {"memory",
       {{"device_scene_bytes", sizeof(SceneHeader) + job.scene.words.size() * sizeof(std::uint32_t)},
        {"scheduler_peak_bytes", nullptr},
        {"largest_worker_peak_bytes", worker_memory}}},
      {"needs", grouped_json(statistics.needs)},
      {"left_out", grouped_json(statistics.left_out)},
      {"costs", statistics.inventory ? inventory_json(*statistics.inventory) : Json(nullptr)},
      {"warnings", statistics.warnings},
      {"problems", outcome.problems}};
}

void add_end(Json& statistics, double write_seconds) {
  statistics["finished"] = utc_now();
  statistics["seconds"]["write"] = write_seconds;
  statistics["memory"]["scheduler_peak_bytes"] = peak_memory_bytes();
}

}  // namespace penumbra
