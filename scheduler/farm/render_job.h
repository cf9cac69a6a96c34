// One image to render, and its outcome.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/device_scene.h"
#include "scheduler/plan/film_accumulator.h"
#include "scheduler/plan/plan_messages.h"
#include "scheduler/plan/work_unit.h"
#include "scheduler/protocol/asset_manifest.h"
#include "worker/device.h"

namespace penumbra {

class CheckpointSink;
struct ResumedState;

struct RenderJob {
  std::optional<JobId> number = {};  ///< on the wire, not used before; nothing: the farm's choice
  DeviceScene scene;
  std::shared_ptr<const AssetManifest> manifest = {};  ///< of the scene; null: the farm makes it
  int x = 0, y = 0, width = 0, height = 0;             ///< film rectangle to render
  std::uint32_t spp = 16;
  std::uint32_t samples_per_pass = 16;  ///< the image depends on it, see FilmAccumulator
  int tile = 64;                        ///< the image does not depend on it
  int priority = 0;                     ///< of jobs with work, that with the highest goes first
  DeviceOptions device;
  std::string reproduce_command;      ///< the `penumbra render` command without a crop, quoted for a shell; a
                                      ///< failed unit is named with it plus `--crop x0,y0,x1,y1`
  std::optional<double> time_budget;  ///< seconds of rendering, with those of an earlier process, after which
                                      ///< no further unit is begun; the first pass is always rendered, and an
                                      ///< image that ends so counts as complete
  std::uint64_t units_at_most =
      kAllUnits;  ///< the first ones, see PhaseUnits; the image depends on `tile` then

  /// Each tile ends as soon as its relative error is at most that, see AdaptiveTile; `spp` is the most that
  /// it gets, and the image depends on `tile`.
  std::optional<double> target_error = {};
  /// Tiles get samples by the errors of a pilot, see SampleAllocation, so that `spp` is their mean; the image
  /// depends on `tile`. Not with a target error, nor with fewer units.
  bool adaptive = false;
  double verify = 0;  ///< share of the units that two workers do, to compare what they return
  std::shared_ptr<ResumedState> before = {};         ///< what there is of it already; the render uses it up
  std::shared_ptr<CheckpointSink> checkpoints = {};  ///< null: none are kept

  // For viewers.
  std::string title;             ///< the scene file
  std::string integrator;        ///< its name
  double center[3] = {0, 0, 0};  ///< of the scene in world space
  std::string tev = {};          ///< address of a tev that shows the render, see parse_tev_address
  /// Watchers choose camera and samples: nothing is rendered until one of them wants samples, at most `spp`,
  /// and the render ends only with `stop`.
  bool interactive = false;
};

struct WorkerShare {
  std::string name;  ///< host:pid
  std::string device;
  std::uint64_t units = 0;
  std::uint64_t samples = 0;
  double busy_seconds = 0;  ///< inside Device::render
  std::uint64_t peak_memory_bytes = 0;
  SceneBytes scene;                     ///< how it came by the job's scene
  std::optional<KernelOrigin> kernels;  ///< nothing where they were compiled with the worker
  std::string ended;                    ///< empty, or why it was lost
};

struct RenderProgress {
  std::uint64_t samples_done = 0, samples_total = 0;
  std::uint64_t samples_before = 0;  ///< of samples_done, those of an earlier process
  double elapsed_seconds = 0;
  double relative_error = 0;  ///< see FilmAccumulator; NaN before it is known
  int workers = 0;            ///< connected
  /// What has happened since the last call, such as a compile, a line each.
  std::vector<std::string> notices = {};
};

struct RenderOutcome {
  FilmAccumulator film;
  bool complete = false;
  std::vector<std::string> problems;  ///< every failed unit, lost worker, rejected result, in plain words
  std::vector<WorkerShare> workers;
  std::uint64_t units_done = 0, units_duplicated = 0, units_requeued = 0;
  std::uint64_t units_verified = 0, units_not_verified = 0;  ///< of those that were to be
  std::uint64_t units_set_aside = 0;  ///< missing in the film, maybe before others that are not
  std::optional<std::uint64_t> units_in_order = {};  ///< see Merge
  bool ended_by_tile = false;   ///< tiles have numbers of samples of their own, and each its own
  bool shares_missing = false;  ///< with adaptive sampling: tiles lack samples, or have other shares
  std::uint32_t passes_finished = 0, passes_total = 0;  ///< merged in every tile; asked for
  // From when the farm took the job, of a single render so from the call; of one that waited for others from
  // its first unit.
  double seconds_to_ready = 0;  ///< until the first worker has the scene and its kernels
  double seconds_to_first_tile = 0;
  double seconds_to_last_tile = 0;  ///< until the last result is merged
  double seconds = 0;
  // Of an earlier process, whose checkpoint this render went on with.
  std::uint64_t samples_before = 0;  ///< over all pixels
  double seconds_before = 0;         ///< of rendering
};

}  // namespace penumbra
