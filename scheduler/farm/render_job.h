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
#include "scheduler/plan/tile_grid.h"
#include "scheduler/render/render_request.h"
#include "worker/device.h"
#include "worker/protocol/asset_manifest.h"
#include "worker/work_unit.h"

namespace penumbra {

class CheckpointSink;
struct ResumedState;

struct RenderJob {
  /// Number on the wire, which must be unused; nothing: chosen by the farm.
  std::optional<JobId> number = {};
  DeviceScene scene;
  std::shared_ptr<const AssetManifest> manifest = {};  ///< of the scene; null: computed by the farm
  int x = 0, y = 0, width = 0, height = 0;             ///< film rectangle to render
  /// Of each pixel; with a target error the limit, with adaptive sampling the mean. At most plan.stop_after.
  std::uint32_t spp = 16;
  RenderRequest request{.plan = {}};  ///< of which nothing is open any more
  int priority = 0;                   ///< among jobs with work the highest goes first
  std::string submitter = {};  ///< among jobs of equal priority, submitters have equal shares of the workers
  DeviceOptions device;        ///< by the request and this machine
  /// The `penumbra render` command without a crop, quoted for a shell; the message about a failed unit adds
  /// `--crop x0,y0,x1,y1`.
  std::string reproduce_command;
  std::shared_ptr<ResumedState> before = {};  ///< the state from which to resume; consumed by the render
  std::shared_ptr<CheckpointSink> checkpoints = {};  ///< null: no checkpoints

  // For viewers.
  std::uint32_t scene_spp = 0;   ///< samples per pixel that the scene, or --spp, asks for; 0: unknown
  std::string title;             ///< name of the scene file
  std::string integrator;        ///< name of the integrator
  double center[3] = {0, 0, 0};  ///< the scene's centre in world space
  std::string tev = {};          ///< address of a tev viewer that shows the render; see parse_tev_address
  /// Viewers choose camera and samples. Nothing is rendered until one of them requests samples, at most
  /// `spp`, and the render ends only with `stop`.
  bool interactive = false;
};

inline TileGrid tile_grid(const RenderJob& job) {
  return {
      job.x, job.y, job.width, job.height, job.request.plan.tile, job.spp, job.request.plan.samples_per_pass};
}

struct WorkerShare {
  std::string name;  ///< host:pid
  std::string device;
  std::uint64_t units = 0;
  std::uint64_t samples = 0;
  double busy_seconds = 0;  ///< time inside Device::render
  std::uint64_t peak_memory_bytes = 0;
  SceneBytes scene;                     ///< where the bytes of the job's scene came from
  std::optional<KernelOrigin> kernels;  ///< nothing if the kernels were compiled into the worker
  std::string ended;                    ///< empty, or why the worker was lost
};

struct RenderProgress {
  std::uint64_t samples_done = 0, samples_total = 0;
  std::uint64_t samples_before = 0;  ///< the part of samples_done from an earlier process
  double elapsed_seconds = 0;
  double relative_error = 0;  ///< see FilmAccumulator; NaN while unknown
  int workers = 0;            ///< number of connected workers
  /// Messages since the last call, such as a compilation; one line each.
  std::vector<std::string> notices = {};
};

struct RenderOutcome {
  FilmAccumulator film;
  bool complete = false;
  std::vector<std::string> problems;  ///< all failed units, lost workers and rejected results, in plain words
  std::vector<WorkerShare> workers;
  std::uint64_t units_done = 0, units_duplicated = 0, units_requeued = 0;
  std::uint64_t units_verified = 0, units_not_verified = 0;  ///< of those chosen for verification
  /// Failed units missing in the film; later units of the same tile may be there.
  std::uint64_t units_set_aside = 0;
  std::optional<std::uint64_t> units_in_order = {};  ///< see Merge
  bool ended_by_tile = false;                        ///< whether tiles have different numbers of samples
  /// Adaptive sampling: some tiles lack samples, or have other numbers of samples than an undisturbed render.
  bool shares_missing = false;
  std::uint32_t passes_finished = 0, passes_total = 0;  ///< passes merged in every tile; passes asked for
  // Times since the farm took the job (for a single render: since the call). For a job that waited for
  // others: since its first unit.
  double seconds_to_ready = 0;  ///< until the first worker has the scene and its kernels
  double seconds_to_first_tile = 0;
  double seconds_to_last_tile = 0;  ///< until the last result is merged
  double seconds = 0;
  // Of an earlier process whose checkpoint this render resumed.
  std::uint64_t samples_before = 0;  ///< over all pixels
  double seconds_before = 0;         ///< of rendering
};

}  // namespace penumbra
