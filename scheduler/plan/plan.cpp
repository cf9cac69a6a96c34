#include "scheduler/plan/plan.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

namespace penumbra {
namespace {

constexpr Seconds kNever = std::numeric_limits<Seconds>::infinity();
constexpr Seconds kNotBegun = -kNever;

}  // namespace

Plan::Plan(LeaseRule leases)
    : leases_(leases),
      shortest_(std::min({leases.initial, leases.minimum, leases.silence, leases.patience, leases.unheard})) {
}

std::vector<PlanOrder> Plan::handle(const PlanEvent& event, Seconds now) {
  now_ = std::max(now_, now);
  orders_.clear();
  changed_.clear();
  all_changed_ = false;
  std::visit([this](const auto& e) { on(e); }, event);
  if (!gave_up()) issue();
  return std::exchange(orders_, {});
}

std::optional<UnitId> Plan::in_hand(WorkerId worker) const {
  const auto found = workers_.find(worker);
  if (found == workers_.end() || found->second.units.empty()) return {};
  return found->second.units.front();
}

bool Plan::is_in_hand(JobId job) const {
  return std::ranges::any_of(workers_, [job](const auto& entry) {
    const std::deque<UnitId>& units = entry.second.units;
    return !units.empty() && units.front().job == job;
  });
}

// --- Events of jobs

void Plan::on(const JobAdded& event) {
  const auto [added, is_new] = jobs_.try_emplace(event.job);
  if (!is_new) return;
  Job& job = added->second;
  job.priority = event.priority;
  job.submitter = event.submitter;
  add_submitter(event.submitter);
  job.as_added = event.phases;
  job.verify = event.verify;
  job.begin();
  units_left_ += job.units_left;
  order_jobs();
  // It still prepares the job's previous version.
  for (auto& [id, worker] : workers_)
    if (worker.preparing == event.job) worker.prepares_in_vain = true;
  tell_if_phase_is_done(event.job);
  all_changed_ = true;
}

void Plan::on(const JobRemoved& event) {
  const auto found = jobs_.find(event.job);
  if (found == jobs_.end()) return;
  forget_units(event.job);
  units_left_ -= found->second.units_left;
  const std::string submitter = found->second.submitter;
  jobs_.erase(found);
  if (std::ranges::none_of(jobs_, [&](const auto& job) { return job.second.submitter == submitter; }))
    spent_.erase(submitter);
  if (!gave_up()) disputes_ = 0;  // disputes of a scheduler that runs for months must not add up
  order_jobs();
  for (auto& [id, worker] : workers_) {
    if (worker.prepared.erase(event.job) > 0 || worker.preparing == event.job)
      orders_.push_back(Forget{id, event.job});
    worker.alone.erase(event.job);
    worker.unfit.erase(event.job);
    worker.proven.erase(event.job);
    update_idle(id, worker);
  }
  all_changed_ = true;
}

void Plan::on(const PriorityChanged& event) {
  const auto found = jobs_.find(event.job);
  if (found == jobs_.end()) return;
  found->second.priority = event.priority;
  order_jobs();
}

void Plan::on(const JobRestarted& event) {
  if (jobs_.contains(event.job)) restart(event.job);
}

void Plan::on(const PhaseOpened& event) {
  const auto found = jobs_.find(event.job);
  if (found == jobs_.end() || found->second.phase != event.phase) return;
  found->second.waits = false;
  tell_if_phase_is_done(event.job);
}

void Plan::on(const MorePasses& event) {
  const auto found = jobs_.find(event.job);
  if (found == jobs_.end()) return;
  Job& job = found->second;
  Phase& phase = job.phases[job.phase];
  if (event.passes <= phase.passes) return;
  const std::uint64_t before = phase.units();
  phase.passes = event.passes;
  phase.queue_tiles();
  count_left(job, phase, std::int64_t(phase.units() - before));
}

void Plan::on(const PassesOfTile& event) {
  const auto found = jobs_.find(event.job);
  if (found == jobs_.end()) return;
  Job& job = found->second;
  Phase& phase = job.phases[job.phase];
  if (phase.closed || event.tile >= phase.tiles || event.passes <= phase.limit[event.tile]) return;
  const std::uint32_t before = phase.end(event.tile);
  phase.limit[event.tile] = event.passes;
  phase.queue(event.tile);
  count_left(job, phase, phase.end(event.tile) - before);
}

void Plan::on(const NoFurtherUnits& event) {
  const auto found = jobs_.find(event.job);
  if (found == jobs_.end()) return;
  Job& job = found->second;
  Phase& phase = job.phases.back();
  const std::uint64_t before = phase.units();
  // The last tile of the last pass that was begun: units up to there are rendered.
  std::uint32_t begun = 1, last = 0;
  for (std::uint32_t tile = 0; tile < phase.tiles; ++tile) {
    const std::uint32_t end = phase.issued_end(tile);
    if (end >= begun) last = tile;
    begun = std::max(begun, end);
  }
  for (std::uint32_t tile = 0; tile < phase.tiles; ++tile) {
    const std::uint32_t own = phase.by_tile ? phase.issued_end(tile) : tile <= last ? begun : begun - 1;
    phase.limit[tile] = std::min(phase.limit[tile], std::max(1u, own));
  }
  phase.closed = true;
  phase.passes = std::min(phase.passes, begun);
  phase.queue_tiles();
  count_left(job, phase, std::int64_t(phase.units() - before));
}

// --- Events of workers

void Plan::on(const WorkerJoined& event) {
  Worker& worker = workers_.try_emplace(event.worker).first->second;
  worker.heard_at = now_;
  update_idle(event.worker, worker);
}

void Plan::on(const WorkerPrepared& event) {
  const auto found = workers_.find(event.worker);
  if (found == workers_.end() || found->second.preparing != event.job) return;
  Worker& worker = found->second;
  worker.preparing.reset();
  worker.preparing_since.reset();
  worker.heard_at = now_;
  update_idle(event.worker, worker);
  const auto job = jobs_.find(event.job);
  // It was told meanwhile to forget the job.
  if (std::exchange(worker.prepares_in_vain, false) || job == jobs_.end()) return;
  worker.prepared.insert(event.job);
  job->second.deaths = 0;
}

void Plan::on(const WorkerUnfit& event) {
  const auto found = workers_.find(event.worker);
  if (found == workers_.end() || found->second.preparing != event.job) return;
  Worker& worker = found->second;
  worker.preparing.reset();
  worker.preparing_since.reset();
  worker.heard_at = now_;
  update_idle(event.worker, worker);
  if (std::exchange(worker.prepares_in_vain, false) || !jobs_.contains(event.job)) return;
  // Its memory may not suffice for two jobs.
  const bool was_alone = worker.prepared.empty() || worker.alone.contains(event.job);
  (was_alone ? worker.unfit : worker.alone).insert(event.job);
  if (was_alone) tell_if_nobody_can(event.job);
}

void Plan::on(const Alive& event) {
  const auto found = workers_.find(event.worker);
  if (found == workers_.end()) return;
  Worker& worker = found->second;
  worker.heard_at = now_;
  if (!worker.hung || !worker.silent) return;
  worker.hung = false;
  check_by(now_);
  update_idle(event.worker, worker);
}

void Plan::on(const Progressed& event) {
  const auto worker = workers_.find(event.worker);
  if (worker == workers_.end() || worker->second.units.empty()) return;
  show_progress(worker->second);
  update_idle(event.worker, worker->second);
}

void Plan::on(const WorkerLost& event) {
  const auto worker = workers_.find(event.worker);
  if (worker == workers_.end()) return;  // dismissed earlier
  // The current unit of a hung worker has been blamed already.
  if (!event.has_left && !worker->second.hung && !worker->second.units.empty()) {
    const UnitId unit = worker->second.units.front();
    blame(unit, event.worker, Fault::kDied);
    Job& job = jobs_.at(unit.job);
    if (++job.deaths_at_units >= deaths_at_units_to_give_up_job(workers_.size()))
      orders_.push_back(NoCapableWorker{unit.job, job.deaths_at_units, true});
  }
  if (!event.has_left && worker->second.units.empty() && worker->second.preparing) {
    const auto job = jobs_.find(*worker->second.preparing);
    // If others render the job, the job is not at fault.
    const auto renders_it = [&](const auto& other) { return other.second.prepared.contains(job->first); };
    if (job != jobs_.end() && ++job->second.deaths >= kDeathsToGiveUpJob &&
        std::ranges::none_of(workers_, renders_it))
      orders_.push_back(NoCapableWorker{job->first, job->second.deaths});
  }
  release(event.worker);
}

void Plan::on(const UnitDone& event) {
  const auto worker = workers_.find(event.worker);
  const bool was_hung = worker != workers_.end() && worker->second.hung;
  const bool was_in_hand =
      worker != workers_.end() && !worker->second.units.empty() && worker->second.units.front() == event.unit;
  if (was_in_hand) show_progress(worker->second);
  const Seconds taken = worker == workers_.end() ? 0 : now_ - worker->second.in_hand_since;
  if (!take_back(event.worker, event.unit)) {
    orders_.push_back(DiscardResult{event.worker, event.unit});
    dismiss(event.worker, Fault::kCorrupt, event.unit);  // it was not given this unit
    return;
  }
  worker->second.proven.insert(event.unit.job);
  worker->second.failures_in_a_row = 0;
  if (was_in_hand && !was_hung) {  // a pause of the worker says nothing about the units
    Job& job = jobs_.at(event.unit.job);
    job.total += taken;
    ++job.timed;
  }

  Unit& unit = units_.at(event.unit);
  if (!unit.closed) {
    accept(event, unit);
  } else if (unit.done_by && unit.hash != event.hash) {
    dispute(event, unit);
  } else {
    if (unit.unverified && unit.done_by) {
      end_check(event.unit, unit);
      ++jobs_.at(event.unit.job).counts.verified;
    }
    orders_.push_back(DiscardResult{event.worker, event.unit});
  }
  settle(event.unit);
}

void Plan::on(const UnitFailed& event) {
  if (!take_back(event.worker, event.unit)) return;
  blame(event.unit, event.worker, Fault::kFailed);
  settle(event.unit);
  if (++workers_.at(event.worker).failures_in_a_row >= kFailuresToDismiss) {
    dismiss(event.worker, Fault::kFailed, event.unit);
  }
}

void Plan::on(const ResultCorrupt& event) {
  if (!workers_.contains(event.worker)) return;
  if (take_back(event.worker, event.unit)) {
    blame(event.unit, event.worker, Fault::kCorrupt);
    settle(event.unit);
  }
  dismiss(event.worker, Fault::kCorrupt, event.unit);
}

void Plan::on(const Tick&) {
  give_up_idle_checks();
  if (now_ >= next_check_) check_leases();
}

// --- Bookkeeping of jobs

void Plan::order_jobs() {
  order_.clear();
  for (const auto& [id, job] : jobs_) order_.push_back(id);
  std::ranges::sort(order_, {}, [this](JobId id) {
    const Job& job = jobs_.at(id);
    return std::tuple(-std::int64_t(job.priority), spent_.at(job.submitter), id);
  });
}

/// Who comes later has no claim on the time before.
void Plan::add_submitter(const std::string& submitter) {
  if (spent_.contains(submitter)) return;
  Seconds least = spent_.empty() ? 0 : spent_.begin()->second;
  for (const auto& [other, spent] : spent_) least = std::min(least, spent);
  spent_[submitter] = least;
}

/// Forgets all issued units of a job, also those that workers hold: results for them are not passed on any
/// more.
void Plan::forget_units(JobId job) {
  const auto is_of_job = [job](const UnitId& unit) { return unit.job == job; };
  for (auto& [id, worker] : workers_) {
    const bool loses_hand = !worker.units.empty() && is_of_job(worker.units.front());
    std::erase_if(worker.units, is_of_job);
    if (loses_hand) {
      worker.hung = false;
      start_lease(worker);
      if (!worker.units.empty()) update_copyable(worker.units.front());
      if (worker.units.empty() && worker.preparing) check_by(now_);
    }
    if (worker.place && is_of_job(*worker.place)) move_to(worker, {});
    update_idle(id, worker);
  }
  std::erase_if(units_, [&](const auto& unit) { return is_of_job(unit.first); });
  std::erase_if(requeued_, is_of_job);
  std::erase_if(suspects_, is_of_job);
  Job& forgotten = jobs_.at(job);
  forgotten.copyable.clear();
  forgotten.checks.clear();
  forgotten.unverified = 0;
  std::erase_if(contributions_, [job](const auto& tiles) { return std::get<1>(tiles.first) == job; });
}

void Plan::restart(JobId id) {
  Job& job = jobs_.at(id);
  forget_units(id);
  for (PhaseUnits& units : job.as_added) units.merged.clear();
  units_left_ -= job.units_left;
  job.begin();
  units_left_ += job.units_left;
  tell_if_phase_is_done(id);
  all_changed_ = true;
}

void Plan::count_left(UnitId id, std::int64_t more) {
  Job& job = jobs_.at(id.job);
  count_left(job, job.phases[id.phase], more);
}

void Plan::count_left(Job& job, Phase& phase, std::int64_t more) {
  phase.left += std::uint64_t(more);
  job.units_left += std::uint64_t(more);
  units_left_ += std::uint64_t(more);
}

/// If the present phase is done, the next one becomes the present one and waits to be opened.
void Plan::tell_if_phase_is_done(JobId id) {
  Job& job = jobs_.at(id);
  if (job.waits || present(job).left > 0 || job.phase + 1 == job.phases.size()) return;
  orders_.push_back(PhaseDone{id, job.phase++});
  job.waits = true;
}

/// Reports a job that every present worker has refused. A worker that joins later may still render it.
void Plan::tell_if_nobody_can(JobId id) {
  const bool nobody = !workers_.empty() && std::ranges::all_of(workers_, [id](const auto& worker) {
    return worker.second.unfit.contains(id);
  });
  if (nobody) orders_.push_back(NoCapableWorker{id});
}

// --- Bookkeeping of units and workers

/// Takes the unit from the worker; false if it did not hold it. Counts as a sign of life.
bool Plan::take_back(WorkerId id, UnitId unit) {
  const auto found = workers_.find(id);
  if (found == workers_.end()) return false;
  Worker& worker = found->second;
  const auto place = std::ranges::find(worker.units, unit);
  if (place == worker.units.end()) return false;
  if (worker.hung || place == worker.units.begin()) start_lease(worker);
  worker.heard_at = now_;
  worker.hung = false;
  worker.units.erase(place);
  units_.at(unit).holders.erase(id);
  update_copyable(unit);
  if (!worker.units.empty()) update_copyable(worker.units.front());
  if (worker.units.empty() && worker.preparing) check_by(now_);
  update_idle(id, worker);
  return true;
}

/// After a holder is gone or given up: queues the unit again, sets it aside or forgets it.
void Plan::settle(UnitId id) {
  const auto found = units_.find(id);
  if (found == units_.end()) return;
  Unit& unit = found->second;
  if (!unit.closed && !rendered_by_someone(unit)) {
    if (unit.faults.size() >= kFaultsToSetAside) {
      unit.closed = true;
      dequeue(id);
      jobs_.at(id.job).set_aside.insert(id);
      count_left(id, -1);
      orders_.push_back(SetAside{id, unit.faults});
      tell_if_phase_is_done(id.job);
    } else {
      enqueue(id, unit);
    }
  }
  update_copyable(id);
  if (!unit.closed || !unit.holders.empty()) return;
  if (unit.unverified)
    jobs_.at(id.job).checks.insert(id);
  else
    units_.erase(found);
}

void Plan::enqueue(UnitId id, const Unit& unit) {
  const bool waited = requeued_.erase(id) + suspects_.erase(id) > 0;
  (unit.faults.empty() ? requeued_ : suspects_).insert(id);
  if (!waited) ++jobs_.at(id.job).counts.requeued;
}

void Plan::dequeue(UnitId id) {
  requeued_.erase(id);
  suspects_.erase(id);
}

void Plan::blame(UnitId id, WorkerId worker, Fault fault) {
  Unit& unit = units_.at(id);
  if (!unit.closed) {
    unit.faults.emplace_back(worker, fault);
    update_copyable(id);
  } else if (unit.unverified && ++unit.failed_checks >= kFaultsToSetAside) {
    end_check(id, unit);
    ++jobs_.at(id.job).counts.not_verified;
  }
}

/// Updates the job's list of units that can be copied.
void Plan::update_copyable(UnitId id) {
  const auto found = units_.find(id);
  if (found == units_.end()) return;
  Unit& unit = found->second;
  std::optional<Seconds> begun;
  if (!unit.closed && unit.holders.size() == 1 && unit.faults.empty()) {
    const Worker& holder = workers_.at(*unit.holders.begin());
    begun = holder.units.front() == id ? holder.in_hand_since : kNotBegun;
  }
  if (begun == unit.copyable) return;
  std::set<std::pair<Seconds, UnitId>>& list = jobs_.at(id.job).copyable;
  if (unit.copyable) list.erase({*unit.copyable, id});
  if (begun) list.insert({*begun, id});
  unit.copyable = begun;
}

/// Updates the sets of workers that can take a unit.
void Plan::update_idle(WorkerId id, Worker& worker) {
  std::optional<std::size_t> wants;
  if (!worker.hung && !worker.preparing && worker.units.size() < kUnitsPerWorker) wants = worker.units.size();
  changed_.push_back(id);
  if (wants == worker.wants) return;
  if (worker.wants) idle_workers_[*worker.wants].erase(id);
  if (wants) idle_workers_[*wants].insert(id);
  worker.wants = wants;
}

/// The worker is gone: its units are returned.
void Plan::release(WorkerId id) {
  const auto worker = workers_.find(id);
  const std::deque<UnitId> held = std::move(worker->second.units);
  if (worker->second.wants) idle_workers_[*worker->second.wants].erase(id);
  move_to(worker->second, {});
  workers_.erase(worker);
  for (const UnitId& unit : held) {
    units_.at(unit).holders.erase(id);
    settle(unit);
  }
  for (const JobId job : order_) tell_if_nobody_can(job);
}

void Plan::dismiss(WorkerId worker, Fault fault, UnitId unit, std::optional<WorkerId> accuser) {
  if (!workers_.contains(worker)) return;
  orders_.push_back(DismissWorker{worker, fault, unit, accuser});
  release(worker);
}

}  // namespace penumbra
