#include "scheduler/render_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <utility>

#include "kernels/features.h"
#include "scheduler/local_workers.h"
#include "scheduler/merge.h"
#include "scheduler/private_socket.h"
#include "scheduler/problem_text.h"
#include "scheduler/protocol/wire.h"
#include "scheduler/render_job_check.h"
#include "scheduler/server.h"
#include "scheduler/tile_grid.h"
#include "scheduler/worker_isa.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kTickInterval{20};
constexpr Seconds kProgressInterval = 0.2;
// The error estimate goes over the whole film; on a large one it must not eat the scheduler's time.
constexpr double kProgressShare = 0.02;
// A pause of this very process (Ctrl-Z, a suspended machine) must not look like one of the workers.
constexpr Seconds kLongestTick = 1;
constexpr int kStartsInARow = 3;  // workers that end before they are ready; then no more are started
// Deaths with no unit finished in between. A unit that kills its workers needs up to four of them to be found
// out.
constexpr int fruitless_deaths_allowed(int workers) { return 4 * workers + 4; }
constexpr Seconds kTimeToDie = 2;        // from the end of a local worker's stream to the end of its process
constexpr Seconds kTimeToBeReady = 300;  // from a local worker's start; it may have to compile kernels

Seconds since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::string kernel_text(const KernelOrigin& kernels) {
  return fmt::format("OpenCL kernels {} {:.2f} s{}{}", kernels.cached ? "from the cache in" : "compiled in",
                     kernels.seconds, kernels.note.empty() ? "" : "; ", kernels.note);
}

/// One call of run_render: carries arrivals to the plan and the plan's orders to merge, workers and report.
class RenderRun {
 public:
  RenderRun(const RenderJob& job, const std::atomic<bool>& stop,
            const std::function<void(const RenderProgress&)>& on_progress)
      : job_(job),
        stop_(stop),
        on_progress_(on_progress),
        planes_(plane_count(job.scene.header.features)),
        grid_(job.x, job.y, job.width, job.height, job.tile, job.spp, job.samples_per_pass),
        plan_({{.tiles = grid_.tiles(), .passes = grid_.passes()}}, job.leases),
        merge_(FilmAccumulator(job.x, job.y, job.width, job.height, planes_), grid_) {}

  Expected<RenderOutcome> run();

 private:
  struct Worker {
    WorkerShare share;
    int pid = 0;
    bool ready = false, dismissed = false, gone = false, ended = false;
    std::optional<UnitId> last_unit;  // in its hand when it was lost
    Seconds gone_since = 0;
  };

  void on(const arrivals::Connected& arrival);
  void on(const arrivals::Compiling& arrival);
  void on(const arrivals::Ready& arrival);
  void on(const arrivals::JobFailed& arrival);
  void on(arrivals::Result& arrival);
  void on(const arrivals::BadResult& arrival);
  void on(const arrivals::UnitFailed& arrival);
  void on(const arrivals::Gone& arrival);

  void tell_plan(const PlanEvent& event, arrivals::Result* result = nullptr);
  void obey(const Assign& order, arrivals::Result*);
  void obey(const MergeResult& order, arrivals::Result* result);
  void obey(const DiscardResult&, arrivals::Result*) {}
  void obey(const SetAside& order, arrivals::Result*);
  void obey(const DismissWorker& order, arrivals::Result*);
  void obey(const RedoTile& order, arrivals::Result*);
  void obey(const GiveUp&, arrivals::Result*);

  void start_workers();
  void look_after_workers();
  void worker_ended(const WorkerExit& exit);
  void advance_clock();
  void tick();
  void report_progress();
  RenderOutcome outcome() &&;

  [[nodiscard]] bool can_go_on() const { return !local_->running().empty() && !plan_.gave_up(); }
  /// Empty for a unit that the job does not have: a confused worker may speak of any.
  [[nodiscard]] RenderUnit unit(const UnitId& id) const {
    const bool exists = id.image == 0 && id.tile < grid_.tiles() && id.pass < grid_.passes();
    return exists ? grid_.unit(id.tile, id.pass) : RenderUnit{};
  }
  [[nodiscard]] std::string detail(const UnitId& id) const {
    const auto found = details_.find(id);
    return found == details_.end() ? "" : found->second;
  }
  [[nodiscard]] WorkerName names() const {
    return [this](WorkerId worker) { return workers_.at(worker).share.name; };
  }
  void problem(std::string text) { problems_.push_back(std::move(text)); }
  /// What every worker says alike is told once.
  [[nodiscard]] bool is_new(const std::string& text) { return said_.insert(text).second; }

  const RenderJob& job_;
  const std::atomic<bool>& stop_;
  const std::function<void(const RenderProgress&)>& on_progress_;
  const int planes_;
  const TileGrid grid_;
  const Clock::time_point started_ = Clock::now();

  Plan plan_;
  Merge merge_;
  std::string scene_hash_;
  std::map<WorkerId, Worker> workers_;
  std::map<int, Seconds> starting_;        // local pids that are not ready yet, since when
  std::map<UnitId, std::string> details_;  // what was said last about a unit that failed
  std::set<std::string> job_failures_;
  std::set<std::string> said_;
  std::vector<std::string> problems_, notices_;
  int failed_starts_ = 0, fruitless_deaths_ = 0;
  bool budget_spent_ = false;
  std::uint64_t samples_done_ = 0;
  Seconds ready_ = 0, first_tile_ = 0, last_tile_ = 0;
  Seconds now_ = 0, plan_time_ = 0, last_tick_ = 0;
  Seconds next_progress_ = 0;
  // The workers talk to the server through the socket, so they go first and the socket last.
  std::optional<PrivateSocket> socket_;
  std::unique_ptr<Server> server_;
  std::optional<LocalWorkers> local_;
};

Expected<RenderOutcome> RenderRun::run() {
  Expected<PrivateSocket> socket = PrivateSocket::create();
  if (!socket) return std::unexpected(socket.error());
  socket_.emplace(std::move(*socket));
  Expected<std::unique_ptr<Server>> server = Server::listen(socket_->address());
  if (!server) return std::unexpected(server.error());
  server_ = std::move(*server);
  local_.emplace(job_.worker_executable, std::vector<std::string>{"--connect", socket_->address()});
  // They start up while the scene is being packed.
  start_workers();
  scene_hash_ = server_->add_asset(job_.scene.serialize());

  while (!plan_.finished() && !stop_ && can_go_on()) {
    std::chrono::milliseconds patience = kTickInterval;
    while (std::optional<Arrival> arrival = server_->next(patience)) {
      advance_clock();
      std::visit([this](auto& a) { on(a); }, *arrival);
      if (plan_.finished() || stop_ || plan_.gave_up() || now_ - last_tick_ > kProgressInterval) break;
      patience = {};
    }
    advance_clock();
    tick();
    look_after_workers();
    report_progress();
  }
  next_progress_ = 0;
  report_progress();
  local_->stop_all();
  server_.reset();

  const bool anyone_was_ready = std::ranges::any_of(workers_, [](const auto& w) { return w.second.ready; });
  if (!anyone_was_ready && !stop_) {
    std::string reasons;
    for (const std::string& text : problems_) reasons += "\n  " + text;
    return fail("no worker could be started:" + reasons);
  }
  return std::move(*this).outcome();
}

// --- What comes from workers

void RenderRun::on(const arrivals::Connected& arrival) {
  Worker& worker = workers_[arrival.worker];
  worker.share.name = fmt::format("{}:{}", arrival.host, arrival.pid);
  worker.pid = arrival.pid;
  const bool embree = job_.scene.header.intersector == INTERSECTOR_EMBREE;
  const auto options = options_for_worker(job_.device, embree, arrival.isas, worker.share.name);
  if (options) {
    server_->send_job(arrival.worker, scene_hash_, *options);
    return;
  }
  worker.dismissed = true;
  worker.share.ended = options.error().message;
  problem(options.error().message);
  server_->refuse(arrival.worker, options.error().message);
}

void RenderRun::on(const arrivals::Compiling& arrival) {
  std::string text = fmt::format("compiling OpenCL kernels for {}", arrival.device);
  if (is_new(text)) notices_.push_back(std::move(text));
}

void RenderRun::on(const arrivals::Ready& arrival) {
  Worker& worker = workers_.at(arrival.worker);
  worker.ready = true;
  worker.share.device = arrival.device;
  worker.share.kernels = arrival.preparation.kernels;
  if (worker.share.kernels && is_new(arrival.device)) notices_.push_back(kernel_text(*worker.share.kernels));
  for (const std::string& warning : arrival.preparation.warnings)
    if (is_new(warning)) problem(warning);
  starting_.erase(worker.pid);
  if (ready_ == 0) ready_ = since(started_);
  tell_plan(WorkerJoined{arrival.worker});
}

void RenderRun::on(const arrivals::JobFailed& arrival) {
  Worker& worker = workers_.at(arrival.worker);
  worker.dismissed = true;
  worker.share.ended = arrival.message;
  server_->dismiss(arrival.worker, arrival.message);
  // Every worker says the same but for names of temporary files in a compiler's log; once is enough.
  const std::string what = arrival.message.substr(0, arrival.message.find('\n'));
  if (job_failures_.insert(what).second) problem("no worker can do this job: " + arrival.message);
}

void RenderRun::on(arrivals::Result& arrival) {
  WorkerShare& share = workers_.at(arrival.worker).share;
  share.busy_seconds += arrival.busy_seconds;
  share.peak_memory_bytes = std::max(share.peak_memory_bytes, arrival.peak_memory_bytes);
  tell_plan(UnitDone{arrival.worker, arrival.unit, arrival.hash}, &arrival);
}

void RenderRun::on(const arrivals::BadResult& arrival) {
  details_[arrival.unit] = arrival.why;
  tell_plan(ResultCorrupt{arrival.worker, arrival.unit});
}

void RenderRun::on(const arrivals::UnitFailed& arrival) {
  details_[arrival.unit] = arrival.message;
  tell_plan(UnitFailed{arrival.worker, arrival.unit});
}

void RenderRun::on(const arrivals::Gone& arrival) {
  Worker& worker = workers_.at(arrival.worker);
  worker.gone = true;
  worker.gone_since = since(started_);
  worker.last_unit = plan_.in_hand(arrival.worker);
  tell_plan(WorkerLost{arrival.worker});
}

// --- What the plan orders

void RenderRun::tell_plan(const PlanEvent& event, arrivals::Result* result) {
  for (const PlanOrder& order : plan_.handle(event, plan_time_)) {
    std::visit([&](const auto& o) { obey(o, result); }, order);
  }
}

void RenderRun::obey(const Assign& order, arrivals::Result*) {
  server_->send_unit(order.worker, order.unit, unit(order.unit), planes_);
}

void RenderRun::obey(const MergeResult& order, arrivals::Result* result) {
  if (first_tile_ == 0) first_tile_ = since(started_);
  const std::uint64_t samples = result->buffer.pixels() * result->buffer.sample_count;
  WorkerShare& share = workers_.at(order.worker).share;
  ++share.units;
  share.samples += samples;
  samples_done_ += samples;
  failed_starts_ = fruitless_deaths_ = 0;
  merge_.add(order.unit.tile, order.unit.pass, std::move(result->buffer));
  last_tile_ = since(started_);
}

void RenderRun::obey(const SetAside& order, arrivals::Result*) {
  merge_.skip(order.unit.tile, order.unit.pass);
  problem(set_aside_text(order, unit(order.unit), detail(order.unit), job_.reproduce_command, names()));
}

void RenderRun::obey(const DismissWorker& order, arrivals::Result*) {
  Worker& worker = workers_.at(order.worker);
  const std::string why = dismissal_text(order, unit(order.unit), detail(order.unit), names());
  worker.dismissed = true;
  worker.share.ended = why;
  problem(why);
  server_->dismiss(order.worker, why);
  local_->kill(worker.pid);
}

void RenderRun::obey(const RedoTile& order, arrivals::Result*) { samples_done_ -= merge_.redo(order.tile); }

void RenderRun::obey(const GiveUp&, arrivals::Result*) {
  problem(fmt::format(
      "workers returned different results for the same unit {} times; none can be trusted, so the "
      "render was given up",
      kDisputesToGiveUp));
}

// --- Processes and time

void RenderRun::start_workers() {
  while (int(local_->running().size()) < job_.workers && failed_starts_ < kStartsInARow &&
         fruitless_deaths_ < fruitless_deaths_allowed(job_.workers)) {
    const Expected<pid_t> pid = local_->start();
    if (pid) {
      starting_[*pid] = since(started_);
    } else {
      problem(pid.error().message);
      failed_starts_ = kStartsInARow;  // trying again would not help
    }
  }
}

void RenderRun::look_after_workers() {
  const Seconds now = since(started_);
  for (auto& [pid, start] : starting_) {
    if (now - start < kTimeToBeReady) continue;
    problem(fmt::format("the worker process {} was ended: not ready after {} s", pid, kTimeToBeReady));
    local_->kill(pid);
    start = now;
  }
  for (const auto& [id, worker] : workers_) {
    if (worker.gone && !worker.ended && now - worker.gone_since > kTimeToDie) local_->kill(worker.pid);
  }
  for (const WorkerExit& exit : local_->reap()) worker_ended(exit);
  start_workers();
}

void RenderRun::worker_ended(const WorkerExit& exit) {
  const bool was_starting = starting_.erase(exit.pid) > 0;
  ++(was_starting ? failed_starts_ : fruitless_deaths_);
  const auto found = std::ranges::find_if(
      workers_, [&](const auto& w) { return w.second.pid == exit.pid && !w.second.ended; });
  if (found == workers_.end()) {
    problem(fmt::format("a worker ended before it was connected: {}", exit.how));
    return;
  }
  Worker& worker = found->second;
  worker.ended = true;
  if (worker.dismissed) return;  // said already
  worker.share.ended = exit.how;
  // The end of its process may be known before that of its stream.
  const std::optional<UnitId> last_unit = worker.gone ? worker.last_unit : plan_.in_hand(found->first);
  const std::string where = last_unit ? " at " + unit_text(unit(*last_unit)) : "";
  problem(fmt::format("worker {} was lost{}: {}", worker.share.name, where, exit.how));
}

void RenderRun::advance_clock() {
  const Seconds now = since(started_);
  plan_time_ += std::min(now - now_, kLongestTick);
  now_ = now;
}

void RenderRun::tick() {
  last_tick_ = now_;
  if (job_.time_budget && !budget_spent_ && now_ > *job_.time_budget) {
    budget_spent_ = true;
    tell_plan(NoFurtherPasses{});
  }
  tell_plan(Tick{});
}

void RenderRun::report_progress() {
  const Seconds now = since(started_);
  if (!on_progress_ || now < next_progress_) return;
  const double error = merge_.film().relative_error();
  const Seconds cost = since(started_) - now;
  next_progress_ = now + std::max(kProgressInterval, cost / kProgressShare);
  on_progress_({.samples_done = samples_done_,
                .samples_total = grid_.samples(plan_.passes(0)),
                .elapsed_seconds = now,
                .relative_error = error,
                .workers = int(std::ranges::count_if(
                    workers_, [](const auto& w) { return w.second.ready && !w.second.gone; })),
                .notices = std::exchange(notices_, {})});
}

RenderOutcome RenderRun::outcome() && {
  RenderOutcome outcome;
  outcome.complete = plan_.finished() && plan_.set_aside().empty();
  outcome.problems = std::move(problems_);
  for (const auto& [id, worker] : workers_) outcome.workers.push_back(worker.share);
  outcome.units_done = plan_.units_done();
  outcome.units_duplicated = plan_.units_duplicated();
  outcome.units_requeued = plan_.units_requeued();
  outcome.passes_finished = merge_.finished_passes();
  outcome.passes_total = grid_.passes();
  outcome.film = std::move(merge_).take_film();
  outcome.seconds_to_ready = ready_;
  outcome.seconds_to_first_tile = first_tile_;
  outcome.seconds_to_last_tile = last_tile_;
  outcome.seconds = since(started_);
  return outcome;
}

}  // namespace

Expected<RenderOutcome> run_render(const RenderJob& job, const std::atomic<bool>& stop,
                                   const std::function<void(const RenderProgress&)>& on_progress) {
  if (const Expected<void> checked = check_render_job(job); !checked) return std::unexpected(checked.error());
  return RenderRun(job, stop, on_progress).run();
}

}  // namespace penumbra
