// Issues units to workers, and detects workers that take too long.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "scheduler/plan/plan.h"

namespace penumbra {

// --- Issuing units

void Plan::issue() {
  // Breadth first: no worker gets a second unit while another one has none. A worker that gets a unit leaves
  // the set.
  for (std::size_t held = 0; held < kUnitsPerWorker; ++held) {
    const std::set<WorkerId>& wanting = idle_workers_[held];
    for (auto next = wanting.begin(); next != wanting.end() && is_anything_waiting(held == 0);) {
      const WorkerId id = *next;
      issue_to(id);
      next = wanting.upper_bound(id);
    }
  }
  if (all_changed_) changed_.assign(idle_workers_[0].begin(), idle_workers_[0].end());
  for (const WorkerId id : std::exchange(changed_, {}))
    if (idle_workers_[0].contains(id)) prepare_one(id, true);
}

void Plan::issue_to(WorkerId id) {
  prepare_one(id, false);
  const std::optional<UnitId> unit = next_for(id);
  if (!unit) return;
  Worker& worker = workers_.at(id);
  if (worker.units.empty()) start_lease(worker);
  worker.units.push_back(*unit);
  units_[*unit].holders.insert(id);
  move_to(worker, *unit);
  Job& job = jobs_.at(unit->job);
  job.checks.erase(*unit);
  spent_.at(job.submitter) += job.expected();
  if (spent_.size() > 1) order_jobs();
  dequeue(*unit);
  update_copyable(*unit);
  update_idle(id, worker);
  orders_.push_back(Assign{id, *unit});
}

/// Whether any worker could be given something. Copies are given only to idle workers.
bool Plan::is_anything_waiting(bool also_copies) const {
  return std::ranges::any_of(jobs_, [&](const auto& entry) {
    const auto& [id, job] = entry;
    return has_work(job, id) || !job.checks.empty() || (also_copies && oldest_straggler(job));
  });
}

std::optional<UnitId> Plan::next_for(WorkerId id) {
  const Worker& worker = workers_.at(id);
  const bool is_idle = worker.units.empty();
  if (worker.preparing || has_suspect(worker)) return {};
  for (const JobId job : order_) {
    if (!worker.prepared.contains(job)) continue;
    if (const auto suspect = suspect_for(id, job)) return is_idle ? suspect : std::nullopt;
    if (const auto unit = requeued_for(id, job)) return unit;
    if (const auto unit = check_for(id, job)) return unit;
    if (const auto unit = fresh_for(worker, job)) return unit;
  }
  return is_idle ? straggler_for(id) : std::nullopt;
}

/// Whether the worker has a blamed unit. Such a unit is issued alone: nothing follows it, no job is prepared
/// after it, and only a worker without other units takes one. So if the worker dies, of the unit.
bool Plan::has_suspect(const Worker& worker) const {
  return !worker.units.empty() && !units_.at(worker.units.front()).faults.empty();
}

/// Whether units of the job wait to be issued.
bool Plan::has_work(const Job& job, JobId id) const {
  const Phase& phase = present(job);
  const auto any_of_job = [id](const std::set<UnitId>& units) {
    const auto first = units.lower_bound(UnitId{.job = id});
    return first != units.end() && first->job == id;
  };
  const bool has_fresh = !job.waits && !phase.fresh.empty();
  return has_fresh || any_of_job(requeued_) || any_of_job(suspects_);
}

/// Tells a worker to prepare the first job that it has not prepared and that precedes all its prepared jobs
/// with work. In advance: any job that may still need it.
void Plan::prepare_one(WorkerId id, bool in_advance) {
  Worker& worker = workers_.at(id);
  if (worker.preparing || has_suspect(worker)) return;
  const auto has_some_for_it = [&](JobId job) {
    return has_work(jobs_.at(job), job) || check_for(id, job).has_value();
  };
  for (const JobId candidate : order_) {
    if (worker.prepared.contains(candidate)) {
      if (!in_advance && has_some_for_it(candidate)) return;
      continue;
    }
    if (worker.unfit.contains(candidate) || (!in_advance && !has_some_for_it(candidate))) continue;
    if (worker.alone.contains(candidate)) {
      if (in_advance || !worker.units.empty()) continue;
      forget_others(id);
    }
    if (int(worker.prepared.size()) >= kJobsPerWorker) {
      if (in_advance) return;
      if (!is_worth_forgetting_another(worker, jobs_.at(candidate))) continue;
      if (!make_room(id)) return;
    }
    worker.preparing = candidate;
    check_by(now_);
    update_idle(id, worker);
    orders_.push_back(Prepare{id, candidate});
    return;
  }
}

/// Makes a worker without units forget all other jobs.
void Plan::forget_others(WorkerId id) {
  for (const JobId job : std::exchange(workers_.at(id).prepared, {})) orders_.push_back(Forget{id, job});
}

/// Not for equal shares alone, as long as they are not far from equal.
bool Plan::is_worth_forgetting_another(const Worker& worker, const Job& job) const {
  return std::ranges::none_of(worker.prepared, [&](JobId id) {
    const Job& other = jobs_.at(id);
    const Seconds lag = spent_.at(other.submitter) - spent_.at(job.submitter);
    return other.priority == job.priority && other.submitter != job.submitter && has_work(other, id) &&
           lag < kLargestLag * Seconds(workers_.size());
  });
}

/// Makes the worker forget the last job of which it holds no unit. Returns whether there is one.
bool Plan::make_room(WorkerId id) {
  Worker& worker = workers_.at(id);
  const auto is_held = [&](JobId job) {
    return std::ranges::any_of(worker.units, [job](const UnitId& unit) { return unit.job == job; });
  };
  const auto last = std::find_if(order_.rbegin(), order_.rend(),
                                 [&](JobId job) { return worker.prepared.contains(job) && !is_held(job); });
  if (last == order_.rend()) return false;
  worker.prepared.erase(*last);
  orders_.push_back(Forget{id, *last});
  return true;
}

std::optional<UnitId> Plan::suspect_for(WorkerId id, JobId job) const {
  for (auto at = suspects_.lower_bound(UnitId{.job = job}); at != suspects_.end() && at->job == job; ++at) {
    const Unit& unit = units_.at(*at);
    if (!unit.holders.contains(id) && !better_elsewhere(unit, id, job)) return *at;
  }
  return {};
}

std::optional<UnitId> Plan::requeued_for(WorkerId id, JobId job) const {
  for (auto at = requeued_.lower_bound(UnitId{.job = job}); at != requeued_.end() && at->job == job; ++at)
    if (!units_.at(*at).holders.contains(id)) return *at;
  return {};
}

std::optional<UnitId> Plan::fresh_for(const Worker& worker, JobId id) {
  Job& job = jobs_.at(id);
  Phase& phase = job.phases[job.phase];
  if (job.waits || phase.fresh.empty()) return {};
  const auto [pass, tile] = *phase.fresh.lower_bound({pass_for(worker, id), 0});
  phase.take(pass, tile);
  return UnitId{id, job.phase, pass, tile};
}

/// The pass of which the worker gets its next new unit; there is one. Passes are kept close to the first one,
/// because results wait for those of earlier passes.
std::uint32_t Plan::pass_for(const Worker& worker, JobId id) const {
  const Job& job = jobs_.at(id);
  const Phase& phase = present(job);
  const auto pass_from = [&](std::uint32_t pass) -> std::optional<std::uint32_t> {
    const auto found = phase.fresh.lower_bound({pass, 0});
    return found == phase.fresh.end() ? std::nullopt : std::optional(found->first);
  };
  const std::uint32_t first = phase.fresh.begin()->first;
  if (phase.at_once == 1) return first;
  if (worker.place && worker.place->job == id && worker.place->phase == job.phase &&
      pass_from(worker.place->pass) == worker.place->pass)
    return worker.place->pass;
  std::uint32_t chosen = first;
  int fewest = std::numeric_limits<int>::max();
  for (auto pass = pass_from(first); pass && *pass - first < phase.at_once && fewest > 0;
       pass = pass_from(*pass + 1)) {
    const auto found = workers_at_.find({id, job.phase, *pass, 0});
    const int workers = found == workers_at_.end() ? 0 : found->second;
    if (workers < fewest) chosen = *pass;
    fewest = std::min(fewest, workers);
  }
  return chosen;
}

/// The worker got the unit, or is at no pass any more.
void Plan::move_to(Worker& worker, std::optional<UnitId> unit) {
  if (unit) unit->tile = 0;
  if (unit == worker.place) return;
  if (worker.place && --workers_at_.at(*worker.place) == 0) workers_at_.erase(*worker.place);
  if (unit) ++workers_at_[*unit];
  worker.place = unit;
}

/// The first unit to be copied, and since when it has been rendering.
std::optional<std::pair<Seconds, UnitId>> Plan::oldest_straggler(const Job& job) const {
  if (job.copyable.empty()) return {};
  const Seconds straggler_age = job.timed == 0 ? kFirstStragglerAge : job.total / double(job.timed);
  // A unit that was not begun is the best one to copy.
  const std::pair<Seconds, UnitId>& oldest = *job.copyable.begin();
  return now_ - oldest.first < straggler_age ? std::nullopt : std::optional(oldest);
}

/// For a worker without units.
std::optional<UnitId> Plan::straggler_for(WorkerId id) {
  std::optional<std::pair<Seconds, UnitId>> chosen;
  for (const JobId candidate : workers_.at(id).prepared) {
    const auto oldest = oldest_straggler(jobs_.at(candidate));
    if (oldest && (!chosen || *oldest < *chosen)) chosen = oldest;
  }
  if (!chosen) return {};
  ++jobs_.at(chosen->second.job).counts.duplicated;
  return chosen->second;
}

/// Whether the unit has failed on this worker, and there is another one on which it has not.
bool Plan::better_elsewhere(const Unit& unit, WorkerId id, JobId job) const {
  const auto failed_on = [&unit](WorkerId worker) {
    return std::ranges::any_of(unit.faults, [&](const auto& fault) { return fault.first == worker; });
  };
  if (!failed_on(id)) return false;
  return std::ranges::any_of(workers_, [&](const auto& other) {
    return !other.second.hung && !other.second.unfit.contains(job) && !failed_on(other.first);
  });
}

bool Plan::rendered_by_someone(const Unit& unit) const {
  return std::ranges::any_of(unit.holders, [this](WorkerId holder) { return !workers_.at(holder).hung; });
}

// --- Timeouts

/// A pause of the worker says nothing about how long parts of units take.
void Plan::show_progress(Worker& worker) {
  if (!worker.hung) {
    Seconds& longest = jobs_.at(worker.units.front().job).longest_wait;
    longest = std::max(longest, now_ - worker.progress_at);
  }
  worker.hung = worker.overdue = false;
  worker.heard_at = worker.progress_at = now_;
  check_by(now_ + shortest_);
}

/// Starts the lease of the worker's current unit. A worker without a unit need not report progress.
void Plan::start_lease(Worker& worker) {
  worker.in_hand_since = worker.progress_at = now_;
  if (worker.units.empty()) worker.heard_at = now_;
  worker.overdue = false;
  check_by(now_ + shortest_);
}

/// Whether it has prepared a job for too long, or without a sign of life for too long. Units that it held
/// before come first.
bool Plan::is_stuck_preparing(Worker& worker) const {
  if (!worker.preparing) return false;
  if (!worker.preparing_since) {
    worker.preparing_since = now_;
    worker.heard_at = std::max(worker.heard_at, now_);
  }
  return now_ - worker.heard_at >= leases_.unheard || now_ - *worker.preparing_since >= leases_.unprepared;
}

/// The time at which to report that the worker is silent or slow.
Seconds Plan::overdue_at(const Worker& worker) const {
  const Seconds longest_wait = jobs_.at(worker.units.front().job).longest_wait;
  return std::min(worker.heard_at + leases_.patience,
                  worker.progress_at + std::max(leases_.patience, 2 * longest_wait));
}

void Plan::tell_if_overdue(WorkerId id, Worker& worker) {
  if (worker.overdue || now_ < overdue_at(worker)) return;
  const Seconds since_heard = now_ - worker.heard_at, since_progress = now_ - worker.progress_at;
  const bool is_silent = since_heard >= leases_.patience;
  worker.overdue = true;
  orders_.push_back(UnitOverdue{id, worker.units.front(), is_silent, is_silent ? since_heard : since_progress,
                                hung_at(worker) - now_});
}

/// Handles expired leases, and computes when the next one may expire.
void Plan::check_leases() {
  std::vector<std::pair<WorkerId, UnitId>> silent;
  std::vector<std::pair<WorkerId, JobId>> stuck;
  next_check_ = std::numeric_limits<Seconds>::infinity();
  for (auto& [id, worker] : workers_) {
    if (worker.units.empty()) {
      if (is_stuck_preparing(worker)) stuck.emplace_back(id, *worker.preparing);
      if (worker.preparing)
        check_by(std::min(worker.heard_at + leases_.unheard, *worker.preparing_since + leases_.unprepared));
      continue;
    }
    const UnitId in_hand = worker.units.front();
    if (worker.hung) {
      if (now_ >= worker.hung_until) silent.emplace_back(id, in_hand);
      check_by(worker.hung_until);
      continue;
    }
    const Seconds end = hung_at(worker);
    if (now_ < end) {
      tell_if_overdue(id, worker);
      check_by(worker.overdue ? end : std::min(end, overdue_at(worker)));
      continue;
    }
    const Lease given = lease(worker);
    worker.hung = true;
    worker.silent = worker.heard_at + given.silence <= end;
    worker.hung_until = now_ + (worker.silent ? given.silence : given.progress);
    check_by(worker.hung_until);
    update_idle(id, worker);
    ++units_.at(in_hand).expired_leases;
    blame(in_hand, id, Fault::kHung);
    for (const UnitId& unit : std::vector(worker.units.begin(), worker.units.end())) settle(unit);
  }
  for (const auto& [id, unit] : silent) dismiss(id, Fault::kHung, unit);
  for (const auto& [id, job] : stuck) dismiss(id, Fault::kUnprepared, UnitId{.job = job});
}

Plan::Lease Plan::lease(const Worker& worker) const {
  const JobId job = worker.units.front().job;
  Seconds base = std::max(leases_.minimum, leases_.factor * jobs_.at(job).longest_wait);
  if (!worker.proven.contains(job)) base = std::max(base, leases_.initial);
  const double growth = std::pow(leases_.growth, units_.at(worker.units.front()).expired_leases);
  return {base * growth, leases_.silence * growth};
}

Seconds Plan::hung_at(const Worker& worker) const {
  const Lease given = lease(worker);
  return std::min(worker.progress_at + given.progress, worker.heard_at + given.silence);
}

}  // namespace penumbra
