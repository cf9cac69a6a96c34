// Renders jobs with worker processes. This is the interface between the command line and the scheduler.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/farm/job_signal.h"
#include "scheduler/farm/render_job.h"
#include "scheduler/farm/service_maker.h"
#include "scheduler/plan/plan.h"
#include "worker/keys/key_folder.h"

namespace penumbra {

class WatchBoard;

struct FarmOptions {
  int workers = 1;                ///< number of local worker processes; 0 if only others join at `listen`
  std::string worker_executable;  ///< path of penumbra-worker
  /// A shell command, such as "srun -n 32", which starts all workers. It is put before their command line;
  /// `workers` is then 1. The workers connect to `listen` if that is given.
  std::string launch = {};
  /// Threads of each launched worker: a number, or "auto": its number of cores.
  std::string launch_threads = "auto";
  std::string listen = {};                ///< an additional listening address; see ListenOptions::more
  std::shared_ptr<const Keys> keys = {};  ///< the keys for `listen`; see listening_keys
  bool comes_back = false;                ///< see ListenOptions::comes_back
  LeaseRule leases = {};                  ///< when a worker is considered hung
  /// Without keys: the token for watching at `listen`; empty: a random one.
  std::string watch_token = {};
  /// A file for the address of `listen`; see keys/address_file.h. If `stop` ends the farm, workers are told
  /// that it will return. Whoever runs the farm ends the file.
  std::filesystem::path address_file = {};
  bool tells_how_to_watch = false;  ///< the first notices to JobSource say how to watch the render
  int open_jobs = 2;                ///< the number of jobs taken from the source at a time
  ServiceMaker service = {};        ///< additional calls served at `listen`
};

/// A connected worker and its statistics.
struct FarmWorker {
  WorkerId id = 0;
  std::string name, device;
  std::uint64_t units = 0, samples = 0;
  double busy_seconds = 0;
  Seconds since = 0;              ///< seconds since it connected
  std::optional<JobId> job = {};  ///< of the unit that it is rendering
};

/// Changes of an open job that the source can request.
struct CancelJob {
  JobId job;
};
using JobChange = std::variant<CancelJob, PriorityChanged>;

/// The source of a farm's jobs, which also receives their outcomes. Its members are called from the farm's
/// own thread and must not block. The farm asks for jobs about fifty times a second, and at once after a
/// notification.
class JobSource {
 public:
  virtual ~JobSource() = default;

  [[nodiscard]] JobSignal& job_signal() { return job_signal_; }

  /// The next job, which must have passed check_render_job. Null if there is none at present.
  virtual std::shared_ptr<const RenderJob> next() = 0;
  /// Whether there will be no more jobs.
  [[nodiscard]] virtual bool is_exhausted() = 0;
  /// Tells the number of a job that was taken, in the order of next().
  virtual void took(JobId) {}
  /// The board on which viewers see a job that was taken.
  virtual void shown(JobId, const std::shared_ptr<WatchBoard>&) {}
  /// Called a few times a second for each open job.
  virtual void progress(JobId, const RenderProgress&) {}
  /// The connected workers, a few times a second. Only called if `wants_workers()`.
  virtual void workers(const std::vector<FarmWorker>&) {}
  [[nodiscard]] virtual bool wants_workers() const { return false; }
  /// Asked a few times a second: changes of open jobs. Others are ignored. A cancelled job ends with what has
  /// been merged.
  [[nodiscard]] virtual std::vector<JobChange> changes() { return {}; }
  /// A message for the user about the farm, such as an address for viewers.
  virtual void notice(const std::string&) {}
  /// The job is over: complete, or as far as it came. Error: no worker could render it.
  virtual void done(JobId, Expected<RenderOutcome>) = 0;

 private:
  JobSignal job_signal_;
};

/// Renders the source's jobs with `options.workers` child processes, which connect over a Unix socket in a
/// private directory, and with workers that join. Blocks until the source is exhausted and its jobs are over,
/// `stop` becomes true (outcomes then hold what is merged), or no worker is left. All children are reaped
/// before it returns. Error: no worker could be started; `done` was called before for all jobs that were
/// taken.
Expected<void> run_farm(const FarmOptions& options, JobSource& source, const std::atomic<bool>& stop);

/// Renders one job. `on_progress` (which may be empty) is called a few times a second from the calling
/// thread. Errors: an invalid job, no worker could be started, or none could render the job.
Expected<RenderOutcome> run_render(const RenderJob& job, const FarmOptions& options,
                                   const std::atomic<bool>& stop,
                                   const std::function<void(const RenderProgress&)>& on_progress);

}  // namespace penumbra
