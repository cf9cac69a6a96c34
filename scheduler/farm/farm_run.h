// The state of one call of run_farm. It passes events to the plan, and executes the plan's orders.
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kernels/host/process.h"
#include "scheduler/farm/job_run.h"
#include "scheduler/farm/private_socket.h"
#include "scheduler/farm/problem_text.h"
#include "scheduler/farm/render_farm.h"
#include "scheduler/farm/server.h"
#include "scheduler/farm/waiting_share.h"
#include "scheduler/farm/worker_processes.h"

namespace penumbra {

class FarmRun {
 public:
  FarmRun(const FarmOptions& options, JobSource& source, const std::atomic<bool>& stop);

  Expected<void> run();

 private:
  using Clock = std::chrono::steady_clock;

  struct Worker {
    std::string name;  // host:pid
    int pid = 0;       // pid of a local process; 0: this farm did not start it
    std::vector<Isa> isas;
    bool ready = false, dismissed = false, has_left = false, gone = false, ended = false;
    std::optional<UnitId> last_unit;  // the unit that it was rendering when it was lost
    Seconds gone_since = 0, ended_since = 0;
    std::uint64_t parts = 0;  // number of parts of units done, as the worker reports
    Seconds since = 0;
    std::string device;
    std::uint64_t units = 0, samples = 0;
    double busy_seconds = 0;
  };

  void on(const arrivals::Connected& arrival);
  void on(const arrivals::Compiling& arrival);
  void on(const arrivals::Ready& arrival);
  void on(const arrivals::Beat& arrival);
  void on(const arrivals::JobFailed& arrival);
  void on(arrivals::Result& arrival);
  void on(const arrivals::BadResult& arrival);
  void on(const arrivals::UnitFailed& arrival);
  void on(const arrivals::Leaving& arrival);
  void on(const arrivals::Gone& arrival);
  void on(const arrivals::JobsNotified&) { notified_ = false; }
  void on(const arrivals::ViewChanged& arrival);
  void on(const arrivals::SamplesWanted& arrival);

  void tell_plan(const PlanEvent& event, arrivals::Result* result = nullptr);
  void execute(const Prepare& order, arrivals::Result*);
  void execute(const Forget& order, arrivals::Result*);
  void execute(const Assign& order, arrivals::Result*);
  void execute(const MergeResult& order, arrivals::Result* result);
  void execute(const DiscardResult&, arrivals::Result*) {}
  void execute(const SetAside& order, arrivals::Result*);
  void execute(const DismissWorker& order, arrivals::Result*);
  void execute(const RedoTile& order, arrivals::Result*);
  void execute(const PhaseDone& order, arrivals::Result*);
  void execute(const RestartJob& order, arrivals::Result*);
  void execute(const NoCapableWorker& order, arrivals::Result*);
  void execute(const UnitOverdue& order, arrivals::Result*);
  void execute(const GiveUp&, arrivals::Result*);

  Expected<void> start();
  void take_arrivals();
  void take_jobs();
  void make_changes();
  void finish_jobs();
  std::unique_ptr<JobRun> take_out(JobId id);
  void end_job(JobId id);
  void end_all_jobs();
  void fail_hopeless_jobs();
  void fail_job(JobId id);
  void refuse(WorkerId id, const std::string& why);
  void check_leases();
  void forget_gone_workers();
  void tell_start_problems();
  void worker_ended(const ChildExit& exit);
  void tell_loss(WorkerId id);
  void advance_clock();
  void tick();
  void publish();
  void report_progress();
  void tell_how_to_watch();
  void tell_if_workers_wait();
  void dismiss_all();

  [[nodiscard]] Seconds since_start() const { return seconds_since(started_); }
  [[nodiscard]] bool can_go_on() const {
    return (options_.workers == 0 || foreign_workers_ > 0 || workers_here_->any_left() ||
            is_an_end_half_known()) &&
           !plan_.gave_up();
  }
  /// Whether, for some worker, only its stream or only its process has ended so far. How to react depends on
  /// both.
  [[nodiscard]] bool is_an_end_half_known() const;
  [[nodiscard]] bool is_done() const { return jobs_.empty() && source_.is_exhausted(); }
  /// Null if the job is over.
  [[nodiscard]] JobRun* job(JobId id);
  [[nodiscard]] RenderUnit unit(const UnitId& id);
  [[nodiscard]] std::string detail(const UnitId& id);
  [[nodiscard]] int ready_workers() const;
  [[nodiscard]] std::vector<WatchedWorker> watched_workers();
  [[nodiscard]] std::vector<FarmWorker> farm_workers();
  [[nodiscard]] WorkerName names() const {
    return [this](WorkerId worker) {
      const auto found = workers_.find(worker);
      return found == workers_.end() ? "of before" : found->second.name;
    };
  }
  /// Reports a problem of the farm to all open jobs, or to the next one if none is open.
  void problem(const std::string& text);
  void notice(const std::string& text);
  /// Whether this notice is new. Identical notices of several workers are shown once.
  [[nodiscard]] bool is_new(const std::string& text) { return said_.insert(text).second; }

  const FarmOptions& options_;
  JobSource& source_;
  const std::atomic<bool>& stop_;
  const Clock::time_point started_ = Clock::now();

  Plan plan_;
  std::map<JobId, std::unique_ptr<JobRun>> jobs_;
  JobId next_job_ = 1;
  std::set<JobId> unrenderable_jobs_;                       // no connected worker can render them
  std::set<JobId> crashing_jobs_;                           // workers repeatedly died while preparing them
  std::map<JobId, std::vector<std::string>> job_failures_;  // the errors that workers reported
  std::vector<std::shared_ptr<WatchBoard>> closed_boards_;  // boards of finished jobs
  std::map<WorkerId, Worker> workers_;
  std::vector<WorkerId> here_;         // workers whose processes this farm has started
  std::vector<PlanEvent> follow_ups_;  // events caused by executing orders, to be passed to the plan next
  std::set<std::string> said_;
  std::vector<std::string> problems_, unsaid_problems_;  // unsaid: no job was open yet
  std::atomic<bool> notified_ = false;                   // a JobsNotified event is on its way
  bool anyone_was_ready_ = false;
  int foreign_workers_ = 0;  // number of connected workers that this farm has not started
  WaitingShare waiting_share_;
  WaitingShare::Totals totals_;
  JobId last_result_of_ = 0;
  bool waiting_was_told_ = false;
  Seconds now_ = 0, next_waiting_ = 0, plan_time_ = 0, last_tick_ = 0, next_workers_ = 0, last_joined_ = 0,
          hopeless_since_ = 0;
  // The workers are connected through this socket, so they are destroyed before it.
  std::optional<PrivateSocket> socket_;
  std::unique_ptr<Server> server_;
  std::optional<WorkerProcesses> workers_here_;
};

}  // namespace penumbra
