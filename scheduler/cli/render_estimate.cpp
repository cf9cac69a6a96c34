#include "scheduler/cli/render_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "scheduler/cli/progress.h"
#include "scheduler/cli/text_layout.h"
#include "scheduler/farm/render_job_check.h"
#include "scheduler/files/json_number.h"
#include "scheduler/plan/sample_allocation.h"
#include "scheduler/plan/tile_grid.h"
#include "scheduler/record/film_image.h"

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kWorkersOfTable[] = {1, 8, 32, 128};
constexpr double kMostSeconds = 120;  // after this not even the first tile is waited for
// The fraction of the time used for the second measurement; the first shows how much of the job that allows.
constexpr double kShareOfSecond = 0.7;

std::uint64_t pixels_of(const RenderJob& job) { return std::uint64_t(job.width) * std::uint64_t(job.height); }

/// Renders some of the job's samples.
Expected<MeasuredWork> measure(PreparedRender& prepared, std::uint32_t spp, double seconds,
                               const std::atomic<bool>& stop) {
  RenderJob& job = prepared.job;
  job.spp = spp;
  job.verify = 0;
  std::atomic<bool> enough = false;
  std::optional<double>
      begun;  // when a worker was ready; large scenes take a while to be fetched and indexed
  const auto outcome = run_render(job, prepared.farm, enough, [&](const RenderProgress& now) {
    if (now.workers > 0 && !begun) begun = now.elapsed_seconds;
    const bool is_measured = begun && now.samples_done > 0 && now.elapsed_seconds - *begun > seconds;
    if (stop || is_measured || now.elapsed_seconds > kMostSeconds) enough = true;
  });
  if (!outcome) return std::unexpected(outcome.error());
  MeasuredWork measured;
  double busy = 0;
  for (const WorkerShare& worker : outcome->workers) {
    measured.samples += worker.samples;
    busy += worker.busy_seconds;
    measured.worker_memory_bytes = std::max(measured.worker_memory_bytes, worker.peak_memory_bytes);
  }
  if (measured.samples == 0)
    return fail(outcome->problems.empty() ? "nothing was rendered in time" : outcome->problems.front());
  measured.threads = job.device.backend == Backend::kNative ? job.device.threads : 1;
  measured.core_seconds = busy * measured.threads;
  measured.start_seconds = outcome->seconds_to_ready;
  measured.seconds = outcome->seconds_to_last_tile - outcome->seconds_to_ready;
  measured.relative_error =
      outcome->complete ? outcome->film.relative_error() : std::numeric_limits<double>::quiet_NaN();
  measured.spp = double(measured.samples) / double(pixels_of(job));
  measured.covered = std::min(1.0, double(measured.samples) / double(pixels_of(job) * spp));
  return measured;
}

}  // namespace

PlannedWork planned_work(const RenderJob& job) {
  const TileGrid grid = tile_grid(job);
  PlannedWork plan;
  plan.samples = grid.samples(grid.passes());
  plan.tiles = grid.tiles();
  plan.passes = grid.passes();
  if (job.plan.adaptive) {
    plan.samples += SampleAllocation::kPilotSpp * pixels_of(job);
    plan.passes += SampleAllocation::kPilotPasses;
  }
  plan.units = std::uint64_t(plan.tiles) * plan.passes;
  plan.result_bytes =
      pixels_of(job) * plan.passes * std::uint64_t(plane_count(job.scene.header.features)) * sizeof(float);
  plan.scene_bytes = job.manifest->bytes();
  plan.scheduler_memory_bytes = memory_of_image(job) + plan.scene_bytes;
  return plan;
}

RenderEstimate estimate_of(const PlannedWork& plan, const MeasuredWork& measured, double target_error,
                           int workers) {
  RenderEstimate estimate{.plan = plan,
                          .measured = measured,
                          .samples = double(plan.samples),
                          .core_seconds = 0,
                          .wall = {},
                          .relative_error = 0};
  const double planned_spp = measured.spp * double(plan.samples) / double(measured.samples);
  double spp = planned_spp;
  // The error of a mean falls with the square root of the number of samples.
  if (target_error > 0 && std::isfinite(measured.relative_error)) {
    const double ratio = measured.relative_error / target_error;
    spp = std::clamp(measured.spp * ratio * ratio, std::min(1.0, planned_spp), planned_spp);
  }
  estimate.samples *= spp / planned_spp;
  estimate.relative_error = measured.relative_error * std::sqrt(measured.spp / spp);
  estimate.core_seconds = measured.core_seconds * estimate.samples / double(measured.samples);
  std::vector<int> counts(std::begin(kWorkersOfTable), std::end(kWorkersOfTable));
  counts.push_back(workers);
  std::ranges::sort(counts);
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  const double units = double(plan.units) * spp / planned_spp;
  const double unit_seconds = estimate.core_seconds / measured.threads / units;
  for (const int count : counts)
    estimate.wall.push_back({count, measured.start_seconds + std::ceil(units / count) * unit_seconds});
  return estimate;
}

Expected<RenderEstimate> measure_estimate(PreparedRender& prepared, double seconds,
                                          const std::atomic<bool>& stop) {
  RenderJob& job = prepared.job;
  const PlannedWork plan = planned_work(job);
  const double target_error = job.plan.target_error.value_or(0);
  const std::uint32_t all = job.spp, samples_per_pass = job.plan.samples_per_pass;
  // On this machine and without checkpoints or limits.
  prepared.farm.launch.clear();
  prepared.farm.listen.clear();
  prepared.farm.tells_how_to_watch = false;
  job.tev.clear();
  job.plan = {.samples_per_pass = samples_per_pass, .tile = job.plan.tile};
  job.time_budget.reset();
  Expected<MeasuredWork> measured = measure(prepared, 1, seconds * (1 - kShareOfSecond), stop);
  if (!measured) return std::unexpected(measured.error());
  const double rate = measured->spp / std::max(measured->seconds, 1e-3);
  const double spp = std::min(double(all), rate * seconds * kShareOfSecond);
  if (spp >= 2 && measured->covered == 1 && !stop) {
    const std::uint32_t passes = std::uint32_t(spp) / samples_per_pass;
    measured = measure(prepared, passes > 0 ? passes * samples_per_pass : std::uint32_t(spp), seconds, stop);
    if (!measured) return std::unexpected(measured.error());
  }
  return estimate_of(plan, *measured, target_error, prepared.farm.workers);
}

std::string estimate_text(const RenderEstimate& e) {
  const auto line = [](const char* name, const std::string& text) {
    return fmt::format("  {:<18} {}\n", name, text);
  };
  std::string text = "Plan\n";
  text += line("samples", fmt::format("{:.4g}", double(e.plan.samples)));
  text += line("units", fmt::format("{}: {} tiles, {} passes", e.plan.units, e.plan.tiles, e.plan.passes));
  text += line("results", size_text(double(e.plan.result_bytes)) + " from workers to the scheduler");
  text += line("scene", size_text(double(e.plan.scene_bytes)) + " to each worker that has it not");
  text += line("scheduler", size_text(double(e.plan.scheduler_memory_bytes)) + " of memory");
  text += "Measured here\n";
  text += line("samples", fmt::format("{:.4g} in {:.1f} s{}", double(e.measured.samples), e.measured.seconds,
                                      e.measured.covered < 1 ? fmt::format(", of {:.0f}% of the image only",
                                                                           e.measured.covered * 100)
                                                             : ""));
  text += line("worker", size_text(double(e.measured.worker_memory_bytes)) +
                             fmt::format(" of memory, ready after {:.2f} s", e.measured.start_seconds));
  text += "Estimate\n";
  if (e.samples < double(e.plan.samples))
    text += line("samples", fmt::format("{:.4g}, until the target error", e.samples));
  text += line("core time",
               fmt::format("{:.0f} core-seconds, {:.2f} core-hours", e.core_seconds, e.core_seconds / 3600));
  for (const WallTime& wall : e.wall)
    text += line("wall time", fmt::format("{} with {} x {} threads", clock_text(wall.seconds), wall.workers,
                                          e.measured.threads));
  text +=
      line("error", std::isfinite(e.relative_error) ? fmt::format("{:.2g}%, or less", e.relative_error * 100)
                                                    : "not known");
  return text;
}

std::string estimate_json(const RenderEstimate& e, const RenderRecord& record) {
  Json wall = Json::array();
  for (const WallTime& time : e.wall)
    wall.push_back({{"workers", time.workers}, {"threads", e.measured.threads}, {"seconds", time.seconds}});
  const Json json = {{"scene", record.scene},
                     {"plan",
                      {{"samples", e.plan.samples},
                       {"tiles", e.plan.tiles},
                       {"passes", e.plan.passes},
                       {"units", e.plan.units},
                       {"result_bytes", e.plan.result_bytes},
                       {"scene_bytes", e.plan.scene_bytes},
                       {"scheduler_memory_bytes", e.plan.scheduler_memory_bytes}}},
                     {"measured",
                      {{"samples", e.measured.samples},
                       {"covered", e.measured.covered},
                       {"seconds", e.measured.seconds},
                       {"start_seconds", e.measured.start_seconds},
                       {"core_seconds", e.measured.core_seconds},
                       {"threads", e.measured.threads},
                       {"worker_memory_bytes", e.measured.worker_memory_bytes},
                       {"relative_error", json_number(e.measured.relative_error)}}},
                     {"estimate",
                      {{"samples", e.samples},
                       {"core_seconds", e.core_seconds},
                       {"wall", wall},
                       {"relative_error", json_number(e.relative_error)}}}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace penumbra
