// `penumbra render --estimate`: predicts the cost of a render from its plan and a few seconds of rendering.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "scheduler/run/render_preparation.h"

namespace penumbra {

constexpr double kEstimateSeconds = 10;  ///< that a render is measured

/// Figures that follow from the job alone; they do not depend on the machine.
struct PlannedWork {
  std::uint64_t pixels = 0;
  std::uint64_t samples = 0;  ///< over all pixels
  std::uint32_t tiles = 0, passes = 0;
  std::uint64_t units = 0;
  std::uint64_t result_bytes = 0;            ///< total size of all results, from workers to the scheduler
  std::uint64_t scene_bytes = 0;             ///< bytes sent to each worker, without a cache
  std::uint64_t image_bytes = 0;             ///< of the EXR file without compression; 0: none is written
  std::uint64_t scheduler_memory_bytes = 0;  ///< for the image, its files and the scene
};
PlannedWork planned_work(const RenderJob& job);

/// Measurements of some passes of the job on this machine.
struct MeasuredWork {
  std::uint64_t samples = 0;
  int width = 0, height = 0;  ///< of the measured image
  double covered = 0;         ///< fraction of its pixels that were rendered
  double seconds = 0;         ///< of rendering, without start-up
  double start_seconds = 0;   ///< until a worker was ready
  double core_seconds = 0;    ///< time of all worker threads; for a GPU that of the device
  int threads = 1;            ///< per worker
  std::uint64_t worker_memory_bytes = 0;
  double relative_error = 0;  ///< of the measured image; see FilmAccumulator; NaN: unknown
  double spp = 0;             ///< mean samples per pixel of that image
};

/// The predicted wall time for `workers` workers like those of the measurement.
struct WallTime {
  int workers = 1;
  double seconds = 0;
};

struct RenderEstimate {
  PlannedWork plan;
  MeasuredWork measured;
  double samples = 0;  ///< expected number of samples; fewer than planned if a target error ends tiles early
  double core_seconds = 0;
  std::vector<WallTime> wall;
  double relative_error = 0;  ///< expected final error, if it falls as for independent samples; NaN: unknown
};

/// Computes the estimate from plan and measurement. `target_error`: 0 for none. A wall time is the start-up
/// time plus the time of the worker with the most units, in whole units.
RenderEstimate estimate_of(const PlannedWork& plan, const MeasuredWork& measured, double target_error,
                           int workers);

/// Renders for at most about `seconds`: first one sample per pixel, then more. If there is no time for many
/// samples of each pixel, the second image is smaller, so that all of the scene is measured and the error is
/// known. `options` are those of `prepared`, whose job is used up. Writes no files.
Expected<RenderEstimate> measure_estimate(const RenderOptions& options, PreparedRender& prepared,
                                          double seconds, const std::atomic<bool>& stop);

}  // namespace penumbra
