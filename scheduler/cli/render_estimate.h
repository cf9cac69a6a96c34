// `penumbra render --estimate`: what a render would cost, from its plan and some seconds of it.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "scheduler/cli/render_preparation.h"

namespace penumbra {

/// Of the job alone: the same wherever it is computed.
struct PlannedWork {
  std::uint64_t samples = 0;  ///< over all pixels
  std::uint32_t tiles = 0, passes = 0;
  std::uint64_t units = 0;
  std::uint64_t result_bytes = 0;            ///< of all units, from workers to the scheduler
  std::uint64_t scene_bytes = 0;             ///< to each worker, without a cache
  std::uint64_t scheduler_memory_bytes = 0;  ///< for the image, its files and the scene
};
PlannedWork planned_work(const RenderJob& job);

/// What some passes of the job took here.
struct MeasuredWork {
  std::uint64_t samples = 0;
  double covered = 0;        ///< share of the image's pixels that were reached
  double seconds = 0;        ///< of rendering, without the start
  double start_seconds = 0;  ///< until a worker was ready
  double core_seconds = 0;   ///< of workers' threads; of a device where that is no CPU, of the device
  int threads = 1;           ///< of each worker
  std::uint64_t worker_memory_bytes = 0;
  double relative_error = 0;  ///< of the image that came of it, see FilmAccumulator; NaN: not known
  double spp = 0;             ///< of that image, on average
};

/// A prediction for so many workers like those of the measurement.
struct WallTime {
  int workers = 1;
  double seconds = 0;
};

struct RenderEstimate {
  PlannedWork plan;
  MeasuredWork measured;
  double samples = 0;  ///< that there will be: fewer than planned where a target error ends tiles
  double core_seconds = 0;
  std::vector<WallTime> wall;
  double relative_error = 0;  ///< at the end, if it falls as that of independent samples; NaN: not known
};

/// Fills in what follows from plan and measurement. `target_error`: 0 for none. Wall times are start, and the
/// units of the busiest worker: whole ones.
RenderEstimate estimate_of(const PlannedWork& plan, const MeasuredWork& measured, double target_error,
                           int workers);

/// Renders for at most about `seconds`, first a sample of every pixel, then some more, and writes no files.
Expected<RenderEstimate> measure_estimate(PreparedRender& prepared, double seconds,
                                          const std::atomic<bool>& stop);

std::string estimate_text(const RenderEstimate& estimate);
std::string estimate_json(const RenderEstimate& estimate, const RenderRecord& record);

}  // namespace penumbra
