#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "scheduler/farm/farm_run.h"
#include "scheduler/farm/worker_isa.h"

namespace penumbra {
namespace {

std::string kernel_text(const KernelOrigin& kernels) {
  return fmt::format("OpenCL kernels {} {:.2f} s{}{}", kernels.cached ? "from the cache in" : "compiled in",
                     kernels.seconds, kernels.note.empty() ? "" : "; ", kernels.note);
}

/// gRPC's name of the peer.
std::string peer_text(const std::string& peer) {
  if (peer.starts_with("unix:")) return "over the Unix socket";
  return "from " + peer.substr(peer.find(':') + 1);
}

}  // namespace

// --- Events from workers

void FarmRun::on(const arrivals::Connected& arrival) {
  Worker& worker = workers_[arrival.worker];
  worker.name = fmt::format("{}:{}", arrival.host, arrival.pid);
  worker.isas = arrival.isas;
  worker.since = since_start();
  worker.pid = workers_here_->claim(arrival.key);
  last_joined_ = now_;
  if (worker.pid == 0) {
    ++foreign_workers_;
    if (!workers_here_->has_launched(arrival.key))
      notice(fmt::format("a worker that {} did not start has joined it: {}, {}",
                         options_.service ? "this service" : "this render", worker.name,
                         peer_text(arrival.peer)));
  } else {
    here_.push_back(arrival.worker);
    workers_here_->is_heard_of(worker.pid, plan_time_);
  }
  if (jobs_.empty()) workers_here_->is_ready(worker.pid);  // ready for whatever job comes
  unrenderable_jobs_.clear();  // the worker may be able to; otherwise the plan reports it again
  tell_plan(WorkerJoined{arrival.worker});
}

void FarmRun::on(const arrivals::Compiling& arrival) {
  std::string text = fmt::format(
      "compiling OpenCL kernels for {}: some seconds, once for scenes that need the same", arrival.device);
  if (is_new(text)) notice(text);
}

void FarmRun::on(const arrivals::Ready& arrival) {
  Worker& worker = workers_.at(arrival.worker);
  worker.ready = anyone_was_ready_ = true;
  worker.device = arrival.device;
  workers_here_->is_ready(worker.pid);
  if (JobRun* of = job(arrival.job)) {
    of->worker_is_ready(arrival, since_start());
    unrenderable_jobs_.erase(arrival.job);
    crashing_jobs_.erase(arrival.job);
    const auto& kernels = arrival.preparation.kernels;
    if (kernels && is_new(fmt::format("{} {}", arrival.job, arrival.device)))
      of->notice(kernel_text(*kernels));
    for (const std::string& warning : arrival.preparation.warnings)
      if (is_new(warning)) of->problem(warning);
  }
  tell_plan(WorkerPrepared{arrival.worker, arrival.job});
}

void FarmRun::on(const arrivals::Beat& arrival) {
  const auto found = workers_.find(arrival.worker);
  if (found == workers_.end()) return;  // beats come before other events, even the first and the last
  Worker& worker = found->second;
  workers_here_->is_heard_of(worker.pid, plan_time_);
  tell_plan(Alive{arrival.worker});
  if (arrival.parts != std::exchange(worker.parts, arrival.parts)) tell_plan(Progressed{arrival.worker});
}

void FarmRun::on(const arrivals::JobFailed& arrival) {
  // All workers report the same, except for names of temporary files in a compiler's log; show it once.
  const std::string what = arrival.message.substr(0, arrival.message.find('\n'));
  JobRun* of = job(arrival.job);
  if (of != nullptr && is_new(fmt::format("{} {}", arrival.job, what))) {
    job_failures_[arrival.job].push_back(arrival.message);
    of->share(arrival.worker).ended = arrival.message;
    of->problem(
        fmt::format("worker {} cannot do this job: {}", workers_.at(arrival.worker).name, arrival.message));
  }
  workers_here_->is_ready(workers_.at(arrival.worker).pid);  // for another job
  tell_plan(WorkerUnfit{arrival.worker, arrival.job});
}

void FarmRun::on(arrivals::Result& arrival) {
  JobRun* of = job(arrival.unit.job);
  if (of == nullptr) return;
  Worker& worker = workers_.at(arrival.worker);
  worker.busy_seconds += arrival.busy_seconds;
  ++worker.units;
  totals_.busy += arrival.busy_seconds;
  totals_.bytes += arrival.buffer.values.size() * sizeof(float);
  ++totals_.results;
  last_result_of_ = arrival.unit.job;
  const RenderUnit done = of->unit(arrival.unit);
  worker.samples += std::uint64_t(done.width) * std::uint64_t(done.height) * done.sample_count;
  WorkerShare& share = of->share(arrival.worker);
  share.busy_seconds += arrival.busy_seconds;
  share.peak_memory_bytes = std::max(share.peak_memory_bytes, arrival.peak_memory_bytes);
  if (arrival.view == of->view().number)
    tell_plan(UnitDone{arrival.worker, arrival.unit, arrival.hash}, &arrival);
}

void FarmRun::on(const arrivals::BadResult& arrival) {
  JobRun* of = job(arrival.unit.job);
  if (of == nullptr || arrival.view != of->view().number) return;
  of->detail(arrival.unit) = arrival.why;
  tell_plan(ResultCorrupt{arrival.worker, arrival.unit});
}

void FarmRun::on(const arrivals::UnitFailed& arrival) {
  JobRun* of = job(arrival.unit.job);
  if (of == nullptr || arrival.view != of->view().number) return;
  of->detail(arrival.unit) = arrival.message;
  tell_plan(UnitFailed{arrival.worker, arrival.unit});
}

/// The worker is not at fault, and its units go to others at once.
void FarmRun::on(const arrivals::Leaving& arrival) {
  Worker& worker = workers_.at(arrival.worker);
  if (worker.dismissed) return;
  worker.has_left = true;
  const std::string text = fmt::format("worker {} has left: {}", worker.name, arrival.reason);
  for (const auto& [id, of] : jobs_)
    if (of->has_share(arrival.worker)) of->share(arrival.worker).ended = arrival.reason;
  notice(text);
  tell_plan(WorkerLost{arrival.worker, true});
}

void FarmRun::on(const arrivals::Gone& arrival) {
  Worker& worker = workers_.at(arrival.worker);
  if (worker.pid == 0) --foreign_workers_;
  worker.gone = true;
  worker.gone_since = since_start();
  worker.last_unit = plan_.in_hand(arrival.worker);
  if (worker.pid == 0) tell_loss(arrival.worker);
  tell_plan(WorkerLost{arrival.worker});
}

/// Reports a worker that this farm did not start and that has gone without a word: killed, or cut off. Of
/// its own workers the end of the process tells more.
void FarmRun::tell_loss(WorkerId id) {
  const Worker& worker = workers_.at(id);
  if (worker.dismissed || worker.has_left) return;  // reported already
  const std::string held =
      worker.last_unit ? fmt::format(" at {}", unit_text(unit(*worker.last_unit))) : std::string();
  const std::string text =
      fmt::format("worker {} was lost{}: its connection broke, as when it is killed or its host is cut off{}",
                  worker.name, held, held.empty() ? "" : "; others render what it held");
  for (const auto& [job, of] : jobs_) {
    if (!of->has_share(id)) continue;
    of->share(id).ended = "its connection broke";
    of->problem(text);
  }
  source_.notice(text);
}

void FarmRun::on(const arrivals::ViewChanged& arrival) {
  JobRun* of = job(arrival.job);
  if (of == nullptr) return;
  of->begin_view(arrival.view);
  for (const auto& [id, worker] : workers_)
    if (!worker.dismissed && !worker.gone) server_->send_view(id, arrival.job, arrival.view);
  tell_plan(JobRestarted{arrival.job});
}

void FarmRun::on(const arrivals::SamplesWanted& arrival) {
  const JobRun* of = job(arrival.job);
  if (of != nullptr && arrival.view == of->view().number)
    tell_plan(MorePasses{arrival.job, of->passes_of(arrival.spp)});
}

// --- Orders of the plan

void FarmRun::tell_plan(const PlanEvent& event, arrivals::Result* result) {
  const std::vector<PlanOrder> orders = plan_.handle(event, plan_time_);
  const auto is_unit = [](const PlanOrder& order) { return std::holds_alternative<Assign>(order); };
  const auto is_result = [](const PlanOrder& order) { return std::holds_alternative<MergeResult>(order); };
  // If there is nothing else to do, send the next unit before merging the result, so that the worker does not
  // wait.
  const bool units_first =
      std::ranges::all_of(orders, [&](const PlanOrder& order) { return is_unit(order) || is_result(order); });
  const auto obey_those = [&](auto&& chosen) {
    for (const PlanOrder& order : orders)
      if (chosen(order)) std::visit([&](const auto& o) { execute(o, result); }, order);
  };
  if (units_first) obey_those(is_unit);
  obey_those([&](const PlanOrder& order) { return !units_first || !is_unit(order); });
  for (const PlanEvent& follow_up : std::exchange(follow_ups_, {})) tell_plan(follow_up);
}

void FarmRun::execute(const Prepare& order, arrivals::Result*) {
  Worker& worker = workers_.at(order.worker);
  JobRun& of = *jobs_.at(order.job);
  of.share(order.worker).name = worker.name;
  const bool embree = of.job().scene.header.intersector == INTERSECTOR_EMBREE;
  const auto options = options_for_worker(of.job().device, embree, worker.isas, worker.name);
  if (!options) {
    const std::string& why = options.error().message;
    job_failures_[order.job].push_back(why);
    follow_ups_.emplace_back(WorkerUnfit{order.worker, order.job});
    if (jobs_.size() == 1 && source_.is_exhausted())
      refuse(order.worker, why);  // no worker can be expected to do better
    else
      of.problem(why);
    return;
  }
  server_->send_job(order.worker, order.job, of.scene_hash(), *options);
  if (of.view().number > 0) server_->send_view(order.worker, order.job, of.view());
}

void FarmRun::execute(const Forget& order, arrivals::Result*) {
  server_->forget_job(order.worker, order.job);
}

void FarmRun::execute(const Assign& order, arrivals::Result*) {
  JobRun& of = *jobs_.at(order.unit.job);
  of.unit_was_given(now_);
  server_->send_unit(order.worker, order.unit, of.unit(order.unit), of.layers());
}

void FarmRun::execute(const MergeResult& order, arrivals::Result* result) {
  // Failures of foreign workers say nothing about local ones.
  const Worker& worker = workers_.at(order.worker);
  if (worker.pid != 0 || workers_here_->launches()) workers_here_->has_worked();
  JobRun& of = *jobs_.at(order.unit.job);
  of.merge(order, *result, since_start());
  std::ranges::copy(of.passes_after(order.unit.tile), std::back_inserter(follow_ups_));
}

void FarmRun::execute(const SetAside& order, arrivals::Result*) {
  JobRun& of = *jobs_.at(order.unit.job);
  of.skip(order.unit);
  std::ranges::copy(of.passes_after(order.unit.tile), std::back_inserter(follow_ups_));
  of.problem(
      set_aside_text(order, of.unit(order.unit), of.detail(order.unit), of.job().reproduce_command, names()));
}

void FarmRun::execute(const DismissWorker& order, arrivals::Result*) {
  Worker& worker = workers_.at(order.worker);
  const std::string why = dismissal_text(order, unit(order.unit), detail(order.unit), names());
  worker.dismissed = true;
  for (const auto& [id, of] : jobs_)
    if (of->has_share(order.worker)) of->share(order.worker).ended = why;
  problem(why);
  server_->dismiss(order.worker, why);
  workers_here_->kill(worker.pid);
}

/// Refuses a worker that none of this farm's jobs can use.
void FarmRun::refuse(WorkerId id, const std::string& why) {
  workers_.at(id).dismissed = true;
  for (const auto& [job, of] : jobs_)
    if (of->has_share(id)) of->share(id).ended = why;
  problem(why);
  server_->refuse(id, why);
  follow_ups_.emplace_back(WorkerLost{id});
}

void FarmRun::execute(const RedoTile& order, arrivals::Result*) { jobs_.at(order.job)->redo(order.tile); }

/// Images have only one phase, so there is nothing to do.
void FarmRun::execute(const PhaseDone&, arrivals::Result*) {}

void FarmRun::execute(const RestartJob& order, arrivals::Result*) {
  JobRun& of = *jobs_.at(order.job);
  of.begin_view({server_->next_view_number(order.job), of.view().view});
  for (const auto& [id, worker] : workers_)
    if (!worker.dismissed && !worker.gone) server_->send_view(id, order.job, of.view());
}

void FarmRun::execute(const NoCapableWorker& order, arrivals::Result*) {
  if (order.deaths == 0) {
    unrenderable_jobs_.insert(order.job);
    hopeless_since_ = now_;
    return;
  }
  crashing_jobs_.insert(order.job);
  job_failures_[order.job].push_back(
      fmt::format("{} workers died while they {}", order.deaths,
                  order.at_units ? "rendered it, one after the other" : "prepared it"));
}

void FarmRun::execute(const UnitOverdue& order, arrivals::Result*) {
  notice(overdue_text(order, unit(order.unit), names()));
}

void FarmRun::execute(const GiveUp&, arrivals::Result*) {
  problem(fmt::format(
      "workers returned different results for the same unit {} times; none can be trusted, so the "
      "render was given up",
      kDisputesToGiveUp));
}

}  // namespace penumbra
