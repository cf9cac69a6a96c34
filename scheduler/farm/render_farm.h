// Renders jobs with worker processes: the interface between the command line and the scheduler.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/farm/job_signal.h"
#include "scheduler/farm/render_job.h"
#include "scheduler/farm/service_maker.h"
#include "scheduler/keys/key_folder.h"
#include "scheduler/plan/plan.h"

namespace penumbra {

struct FarmOptions {
  int workers = 1;                ///< local worker processes; 0 where others join at `listen`
  std::string worker_executable;  ///< path of penumbra-worker
  /// A command of a shell, such as "srun -n 32", which starts all workers, put before their command line;
  /// `workers` is then 1. They connect to `listen` if that is given.
  std::string launch = {};
  std::string launch_threads = "auto";    ///< of each of those: a number, or auto: as many as it has cores
  std::string listen = {};                ///< another address to be reached at, see ListenOptions::more
  std::shared_ptr<const Keys> keys = {};  ///< of `listen`, see listening_keys
  bool comes_back = false;                ///< see ListenOptions::comes_back
  LeaseRule leases = {};                  ///< when a worker counts as hung
  int largest_tile = 64;                  ///< of any job: results are not taken if they are larger
  bool tells_how_to_watch = false;        ///< in the first notices of JobSource
  int open_jobs = 2;                      ///< so many are taken from the source at a time
  ServiceMaker service = {};              ///< further calls at `listen`
};

/// A worker that is connected, and what it has done so far.
struct FarmWorker {
  WorkerId id = 0;
  std::string name, device;
  std::uint64_t units = 0, samples = 0;
  double busy_seconds = 0;
  Seconds since = 0;              ///< it has been there so long
  std::optional<JobId> job = {};  ///< of the unit in its hand
};

/// What is wanted of a job that is open.
struct CancelJob {
  JobId job;
};
using JobChange = std::variant<CancelJob, PriorityChanged>;

/// Where a farm's jobs come from, and what becomes of them. Called from the farm's own thread, which must not
/// wait here. It asks for jobs some fifty times a second, and when that is notified.
class JobSource {
 public:
  virtual ~JobSource() = default;

  [[nodiscard]] JobSignal& job_signal() { return job_signal_; }

  /// The next job, checked by check_render_job; null if none is at hand.
  virtual std::shared_ptr<const RenderJob> next() = 0;
  /// Whether no more will come.
  [[nodiscard]] virtual bool is_exhausted() = 0;
  /// A job that was taken, in the order of next(), has this number.
  virtual void took(JobId) {}
  /// A few times a second, for each job that is open.
  virtual void progress(JobId, const RenderProgress&) {}
  /// A few times a second: who is there. Only where `wants_workers()`.
  virtual void workers(const std::vector<FarmWorker>&) {}
  [[nodiscard]] virtual bool wants_workers() const { return false; }
  /// A few times a second: what is to be done with jobs that are open; others are ignored. One that is
  /// cancelled is over, with what is merged of it.
  [[nodiscard]] virtual std::vector<JobChange> changes() { return {}; }
  /// What has happened on the farm, such as an address to be watched at, for people.
  virtual void notice(const std::string&) {}
  /// The job is over: complete, or as far as it came. The error: no worker could do it.
  virtual void done(JobId, Expected<RenderOutcome>) = 0;

 private:
  JobSignal job_signal_;
};

/// Renders what the source has with `options.workers` child processes over a Unix socket in a private
/// directory, and with whoever joins. Blocks until the source is exhausted and its jobs are over, `stop`
/// becomes true (outcomes then hold what is merged), or nothing can go on. All children are reaped before it
/// returns. Fails if no worker could be started; jobs that were taken have had their `done` before.
Expected<void> run_farm(const FarmOptions& options, JobSource& source, const std::atomic<bool>& stop);

/// One job. `on_progress` (which may be empty) is called a few times a second from the calling thread. Fails
/// if the job makes no sense, or if no worker could be started or do the job.
Expected<RenderOutcome> run_render(const RenderJob& job, const FarmOptions& options,
                                   const std::atomic<bool>& stop,
                                   const std::function<void(const RenderProgress&)>& on_progress);

}  // namespace penumbra
