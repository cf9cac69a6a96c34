#include "scheduler/estimate/render_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "scheduler/farm/render_job_check.h"
#include "scheduler/plan/render_memory.h"
#include "scheduler/plan/sample_allocation.h"
#include "scheduler/plan/tile_grid.h"
#include "scheduler/record/film_image.h"

namespace penumbra {
namespace {

constexpr int kWorkersOfTable[] = {1, 8, 32, 128};
constexpr double kMostSeconds = 120;  // after this not even the first tile is waited for
// The fraction of the time used for the second measurement; the first shows how much of the job that allows.
constexpr double kShareOfSecond = 0.7;
// Fewer samples per pixel show the error badly. Instead, a smaller image is measured.
constexpr double kLeastSpp = 32;
constexpr double kLeastSide = 32;  // of that image, in pixels

std::uint64_t pixels_of(const RenderJob& job) { return std::uint64_t(job.width) * std::uint64_t(job.height); }

/// Renders some of the job's samples.
Expected<MeasuredWork> measure(PreparedRender& prepared, std::uint32_t spp, double seconds,
                               const std::atomic<bool>& stop) {
  RenderJob& job = prepared.job;
  job.spp = spp;
  job.request.verify = 0;
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
  measured.width = job.width;
  measured.height = job.height;
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

/// On this machine and without checkpoints or limits.
void make_local(PreparedRender& prepared) {
  prepared.farm.launch.clear();
  prepared.farm.listen.clear();
  prepared.farm.address_file.clear();
  prepared.farm.tells_how_to_watch = false;
  RenderJob& job = prepared.job;
  job.tev.clear();
  job.request.plan = {.samples_per_pass = job.request.plan.samples_per_pass, .tile = job.request.plan.tile};
  job.request.time_budget.reset();
}

/// Measures the same render with a smaller film.
Expected<MeasuredWork> measure_smaller(RenderOptions options, const FarmOptions& farm, double scale,
                                       std::uint32_t spp, double seconds, const std::atomic<bool>& stop) {
  options.film_scale = scale;
  auto prepared = prepare_render(options);
  if (!prepared) return std::unexpected(prepared.error());
  make_local(*prepared);
  prepared->farm.worker_executable = farm.worker_executable;
  return measure(*prepared, spp, seconds, stop);
}

}  // namespace

PlannedWork planned_work(const RenderJob& job) {
  const TileGrid grid = tile_grid(job);
  PlannedWork plan;
  plan.pixels = pixels_of(job);
  plan.samples = grid.samples(grid.passes());
  plan.tiles = grid.tiles();
  plan.passes = grid.passes();
  if (job.request.plan.adaptive) {
    plan.samples += SampleAllocation::kPilotSpp * pixels_of(job);
    plan.passes += SampleAllocation::kPilotPasses;
  }
  plan.units = std::uint64_t(plan.tiles) * plan.passes;
  plan.result_bytes =
      pixels_of(job) * plan.passes * std::uint64_t(plane_count(job.scene.header.features)) * sizeof(float);
  plan.scene_bytes = job.manifest->bytes();
  const FilmLayers layers(job.scene.header.features, job.scene.header.matte_count);
  const int channels = image_channels(layers) + (layers.mattes() > 0 ? kMatteChannels : 0);
  plan.image_bytes = pixels_of(job) * std::uint64_t(channels) * sizeof(float);
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
  const double planned_spp = double(plan.samples) / double(plan.pixels);
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

Expected<RenderEstimate> measure_estimate(const RenderOptions& options, PreparedRender& prepared,
                                          double seconds, const std::atomic<bool>& stop) {
  RenderJob& job = prepared.job;
  PlannedWork plan = planned_work(job);
  if (!prepared.files.exr) plan.image_bytes = 0;
  const double target_error = job.request.plan.target_error.value_or(0);
  const std::uint32_t all = job.spp, samples_per_pass = job.request.plan.samples_per_pass;
  make_local(prepared);
  Expected<MeasuredWork> measured = measure(prepared, 1, seconds * (1 - kShareOfSecond), stop);
  if (!measured) return std::unexpected(measured.error());
  const auto pixels = double(plan.pixels);
  const double rate = double(measured->samples) / std::max(measured->seconds, 1e-3);
  const double spp = std::min(double(all), rate * seconds * kShareOfSecond / pixels);
  const double least = std::min(double(all), kLeastSpp);
  // The cost of a photon map does not depend on the size of the image.
  const bool can_shrink = job.scene.header.integrator.photons == PHOTONS_NONE;
  const double least_scale = std::min(1.0, kLeastSide / std::min(job.width, job.height));
  if (stop || all < 2) return estimate_of(plan, *measured, target_error, prepared.farm.workers);
  const MeasuredWork first = *measured;
  if (spp < least && can_shrink) {
    job.scene = {};  // two copies of a large scene might not fit into memory
    const double scale = std::max(least_scale, std::sqrt(spp / least));
    measured = measure_smaller(options, prepared.farm, scale, std::uint32_t(least), seconds, stop);
  } else if (spp >= 2 && first.covered == 1) {
    const std::uint32_t passes = std::uint32_t(spp) / samples_per_pass;
    measured = measure(prepared, passes > 0 ? passes * samples_per_pass : std::uint32_t(spp), seconds, stop);
  }
  if (!measured) return std::unexpected(measured.error());
  measured->start_seconds = first.start_seconds;
  measured->worker_memory_bytes = std::max(measured->worker_memory_bytes, first.worker_memory_bytes);
  return estimate_of(plan, *measured, target_error, prepared.farm.workers);
}

}  // namespace penumbra
