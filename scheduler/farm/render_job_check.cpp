#include "scheduler/farm/render_job_check.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

#include "scheduler/plan/adaptive_tile.h"
#include "scheduler/plan/render_memory.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

constexpr std::uint64_t kMostTiles = std::uint64_t(1) << 22;
constexpr std::uint64_t kMostPassesAtOnce = 64;

std::uint64_t bytes_per_pixel(const RenderJob& job) {
  const int films_beside =
      (job.checkpoints ? 1 : 0) + (job.request.plan.target_error ? AdaptiveTile::kMostFilms : 0);
  return pixel_memory(FilmLayers(job.scene.header.features, job.scene.header.matte_count))
      .peak(!job.interactive, films_beside);
}

}  // namespace

std::uint64_t memory_here() {
  return std::uint64_t(sysconf(_SC_PHYS_PAGES)) * std::uint64_t(sysconf(_SC_PAGESIZE));
}

std::uint64_t memory_of_image(const RenderJob& job) {
  return std::uint64_t(job.width) * std::uint64_t(job.height) * bytes_per_pixel(job);
}

std::uint32_t passes_at_once(const RenderJob& job) {
  const SceneHeader& h = job.scene.header;
  if (h.integrator.photons != PHOTONS_PROGRESSIVE || job.interactive) return 1;
  const std::uint64_t bytes_of_pass =
      std::uint64_t(job.width) * std::uint64_t(job.height) * std::uint64_t(plane_count(h.features)) * 4;
  const std::uint64_t most = std::min(kMostPassesAtOnce, kMostTiles / tile_grid(job).tiles());
  return std::uint32_t(std::clamp<std::uint64_t>(memory_here() / 4 / bytes_of_pass, 1, most));
}

Expected<void> check_render_job(const RenderJob& job) {
  const auto within = [](int from, int size, int limit) {
    return from >= 0 && size >= 1 && size <= limit - from;
  };
  if (!within(job.x, job.width, job.scene.header.film.width) ||
      !within(job.y, job.height, job.scene.header.film.height)) {
    return fail(fmt::format(
        "the rectangle of {} x {} pixels at ({}, {}) is empty or not inside the film of {} x {}", job.width,
        job.height, job.x, job.y, job.scene.header.film.width, job.scene.header.film.height));
  }
  if (job.request.plan.tile < 1 || job.request.plan.tile > kMaxTile) {
    return fail(fmt::format("tiles of {} pixels; 1 to {} are possible", job.request.plan.tile, kMaxTile));
  }
  const auto across = [&](int size) {
    return (std::uint64_t(size) + job.request.plan.tile - 1) / job.request.plan.tile;
  };
  if (across(job.width) * across(job.height) > kMostTiles) {
    return fail(
        fmt::format("tiles of {} pixels cut {} x {} pixels into more than {} pieces; take larger tiles",
                    job.request.plan.tile, job.width, job.height, kMostTiles));
  }
  // In double, so that nothing overflows.
  const double bytes = double(job.width) * double(job.height) * double(bytes_per_pixel(job));
  const std::uint64_t memory = memory_here();
  if (bytes > double(memory)) {
    return fail(
        fmt::format("{} x {} pixels need {:.1f} GB, {} bytes each for their statistics, layers and files; "
                    "this machine has {:.1f} GB. Render the image in several crops, or without layers "
                    "(--no-features)",
                    job.width, job.height, bytes * 1e-9, bytes_per_pixel(job), double(memory) * 1e-9));
  }
  if (!(job.request.verify >= 0 && job.request.verify <= 1))
    return fail(fmt::format("--verify is {}; it must be between 0 and 1", job.request.verify));
  if (job.spp < 1) return fail("0 samples per pixel; at least 1 is needed");
  if (job.request.plan.samples_per_pass < 1 || job.request.plan.samples_per_pass > kMaxSamplesPerUnit) {
    return fail(fmt::format("passes of {} samples; 1 to {} are possible", job.request.plan.samples_per_pass,
                            kMaxSamplesPerUnit));
  }
  const IntegratorParameters& integrator = job.scene.header.integrator;
  if (integrator.photons == PHOTONS_PROGRESSIVE &&
      std::uint32_t(integrator.samples_per_map) != job.request.plan.samples_per_pass)
    return fail(
        fmt::format("passes of {} samples in a scene with a photon map for every {}; the samples of "
                    "a pass must share a map",
                    job.request.plan.samples_per_pass, integrator.samples_per_map));
  if (integrator.photons != PHOTONS_NONE && job.request.plan.adaptive)
    return fail(
        "--adaptive: it distributes samples by their noise, which is not the error of photon mapping; leave "
        "it out, or take another integrator");
  return {};
}

}  // namespace penumbra
