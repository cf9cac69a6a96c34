#include "scheduler/plan/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace penumbra {

Plan::Plan(std::vector<ImageUnits> images, LeaseRule leases) : leases_(leases) {
  for (const ImageUnits& image : images) {
    images_.push_back({.all = image, .passes = image.passes});
    units_total_ += std::uint64_t(image.tiles) * image.passes;
  }
  units_left_ = units_total_;
}

std::vector<PlanOrder> Plan::handle(const PlanEvent& event, Seconds now) {
  now_ = std::max(now_, now);
  orders_.clear();
  std::visit([this](const auto& e) { on(e); }, event);
  if (!gave_up()) issue();
  return std::exchange(orders_, {});
}

std::optional<UnitId> Plan::in_hand(WorkerId worker) const {
  const auto found = workers_.find(worker);
  if (found == workers_.end() || found->second.units.empty()) return {};
  return found->second.units.front();
}

// --- What happened

void Plan::on(const WorkerJoined& event) { workers_.try_emplace(event.worker).first->second.heard_at = now_; }

void Plan::on(const Alive& event) {
  const auto found = workers_.find(event.worker);
  if (found == workers_.end()) return;
  Worker& worker = found->second;
  worker.heard_at = now_;
  if (worker.hung && worker.silent) worker.hung = false;
}

void Plan::on(const Progressed& event) {
  const auto worker = workers_.find(event.worker);
  if (worker == workers_.end() || worker->second.units.empty()) return;
  show_progress(worker->second);
}

void Plan::on(const WorkerLost& event) {
  const auto worker = workers_.find(event.worker);
  if (worker == workers_.end()) return;  // dismissed before
  // A hung worker's unit in hand has been blamed already.
  if (!worker->second.hung && !worker->second.units.empty()) {
    blame(worker->second.units.front(), event.worker, Fault::kDied);
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
    dismiss(event.worker, Fault::kCorrupt, event.unit);  // it was not asked for this unit
    return;
  }
  worker->second.proven = true;
  worker->second.failures_in_a_row = 0;
  if (was_in_hand && !was_hung) {  // a pause of the worker says nothing about the units
    total_ += taken;
    ++timed_;
  }

  Unit& unit = units_.at(event.unit);
  if (!unit.closed) {
    accept(event, unit);
  } else if (unit.done_by && unit.hash != event.hash) {
    dispute(event, unit);
  } else {
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

void Plan::on(const MorePasses& event) {
  Image& image = images_[event.image];
  if (event.passes <= image.passes) return;
  const std::uint64_t more = std::uint64_t(image.all.tiles) * (event.passes - image.passes);
  image.passes = event.passes;
  units_left_ += more;
  units_total_ += more;
}

void Plan::on(const NoFurtherPasses&) {
  for (Image& image : images_) {
    const std::uint32_t begun = image.next_pass + (image.next_tile > 0 ? 1 : 0);
    const std::uint32_t passes = std::min(image.passes, std::max(1u, begun));
    const std::uint64_t dropped = std::uint64_t(image.all.tiles) * (image.passes - passes);
    image.passes = passes;
    units_left_ -= dropped;
    units_total_ -= dropped;
  }
}

void Plan::on(const Tick&) {
  std::vector<std::pair<WorkerId, UnitId>> silent;
  for (auto& [id, worker] : workers_) {
    if (worker.units.empty()) continue;
    const UnitId in_hand = worker.units.front();
    if (worker.hung) {
      if (now_ >= worker.hung_until) silent.emplace_back(id, in_hand);
      continue;
    }
    const Seconds end = hung_at(worker);
    if (now_ < end) {
      tell_if_overdue(id, worker);
      continue;
    }
    const Lease given = lease(worker);
    worker.hung = true;
    worker.silent = worker.heard_at + given.silence <= end;
    worker.hung_until = now_ + (worker.silent ? given.silence : given.progress);
    ++units_.at(in_hand).expired_leases;
    blame(in_hand, id, Fault::kHung);
    for (const UnitId& unit : std::vector(worker.units.begin(), worker.units.end())) settle(unit);
  }
  for (const auto& [id, unit] : silent) dismiss(id, Fault::kHung, unit);
}

// --- Bookkeeping of units and workers

/// Ends the worker's hold of the unit; false if it did not have it. The worker shows that it is alive.
bool Plan::take_back(WorkerId id, UnitId unit) {
  const auto found = workers_.find(id);
  if (found == workers_.end()) return false;
  Worker& worker = found->second;
  const auto place = std::ranges::find(worker.units, unit);
  if (place == worker.units.end()) return false;
  if (worker.hung || place == worker.units.begin()) take_in_hand(worker);
  worker.heard_at = now_;
  worker.hung = false;
  worker.units.erase(place);
  units_.at(unit).holders.erase(id);
  return true;
}

/// After a holder is gone or given up: queues, sets aside or forgets the unit.
void Plan::settle(UnitId id) {
  const auto found = units_.find(id);
  if (found == units_.end()) return;
  Unit& unit = found->second;
  if (!unit.closed && !rendered_by_someone(unit)) {
    if (unit.faults.size() >= kFaultsToSetAside) {
      unit.closed = true;
      dequeue(id);
      set_aside_.insert(id);
      --units_left_;
      orders_.push_back(SetAside{id, unit.faults});
    } else {
      enqueue(id, unit);
    }
  }
  if (unit.closed && unit.holders.empty()) units_.erase(found);
}

void Plan::enqueue(UnitId id, const Unit& unit) {
  const bool waited = requeued_.erase(id) + suspects_.erase(id) > 0;
  (unit.faults.empty() ? requeued_ : suspects_).insert(id);
  if (!waited) ++units_requeued_;
}

void Plan::dequeue(UnitId id) {
  requeued_.erase(id);
  suspects_.erase(id);
}

void Plan::blame(UnitId id, WorkerId worker, Fault fault) {
  Unit& unit = units_.at(id);
  if (!unit.closed) unit.faults.emplace_back(worker, fault);
}

/// The worker is gone: what it held goes back.
void Plan::release(WorkerId id) {
  const auto worker = workers_.find(id);
  const std::deque<UnitId> held = std::move(worker->second.units);
  workers_.erase(worker);
  for (const UnitId& unit : held) {
    units_.at(unit).holders.erase(id);
    settle(unit);
  }
}

void Plan::dismiss(WorkerId worker, Fault fault, UnitId unit, std::optional<WorkerId> accuser) {
  if (!workers_.contains(worker)) return;
  orders_.push_back(DismissWorker{worker, fault, unit, accuser});
  release(worker);
}

void Plan::accept(const UnitDone& event, Unit& unit) {
  unit.closed = true;
  unit.hash = event.hash;
  unit.done_by = event.worker;
  dequeue(event.unit);
  --units_left_;
  contributions(event.worker, event.unit.image)[event.unit.tile] = true;
  orders_.push_back(MergeResult{event.worker, event.unit});
}

void Plan::dispute(const UnitDone& event, Unit& unit) {
  const WorkerId first = *unit.done_by;
  const WorkerId second = event.worker;
  orders_.push_back(DiscardResult{second, event.unit});
  dismiss(first, Fault::kDisputed, event.unit, second);
  dismiss(second, Fault::kDisputed, event.unit, first);
  if (++disputes_ >= kDisputesToGiveUp) {
    orders_.push_back(GiveUp{});
    return;
  }
  redo_work_of(first, second);
}

/// Chan's merge cannot be undone for one unit, so the tiles that the two workers had a hand in start afresh.
void Plan::redo_work_of(WorkerId first, WorkerId second) {
  for (std::uint32_t i = 0; i < images_.size(); ++i) {
    const Image& image = images_[i];
    const std::vector<bool>& of_first = contributions(first, i);
    const std::vector<bool>& of_second = contributions(second, i);
    for (std::uint32_t tile = 0; tile < image.all.tiles; ++tile) {
      if (!of_first[tile] && !of_second[tile]) continue;
      orders_.push_back(RedoTile{i, tile});
      const std::uint32_t issued = image.next_pass + (tile < image.next_tile ? 1 : 0);
      for (std::uint32_t pass = 0; pass < issued; ++pass) reopen({i, pass, tile});
    }
    contributions_.erase({first, i});
    contributions_.erase({second, i});
  }
}

void Plan::reopen(UnitId id) {
  if (set_aside_.contains(id)) return;
  const auto [found, is_new] = units_.try_emplace(id);
  Unit& unit = found->second;
  if (!is_new && !unit.closed) return;  // on its way already
  unit.closed = false;
  unit.done_by.reset();
  ++units_left_;
  settle(id);
}

std::vector<bool>& Plan::contributions(WorkerId worker, std::uint32_t image) {
  std::vector<bool>& tiles = contributions_[{worker, image}];
  tiles.resize(images_[image].all.tiles);
  return tiles;
}

// --- Who gets what

void Plan::issue() {
  // Breadth first: no worker gets a second unit while another one has none.
  for (std::size_t wanted = 1; wanted <= kUnitsPerWorker; ++wanted) {
    for (auto& [id, worker] : workers_) {
      if (worker.hung || worker.units.size() >= wanted) continue;
      const std::optional<UnitId> unit = next_for(id);
      if (!unit) continue;
      if (worker.units.empty()) take_in_hand(worker);
      worker.units.push_back(*unit);
      units_[*unit].holders.insert(id);
      dequeue(*unit);
      orders_.push_back(Assign{id, *unit});
    }
  }
}

std::optional<UnitId> Plan::next_for(WorkerId id) {
  const Worker& worker = workers_.at(id);
  const std::optional<UnitId> suspect = suspect_for(id);
  if (worker.units.empty()) {
    if (suspect) return suspect;
  } else if (suspect || !units_.at(worker.units.front()).faults.empty()) {
    return {};  // a blamed unit travels alone: nothing follows it, and a worker empties its hands to take one
  }
  if (const auto unit = requeued_for(id)) return unit;
  if (const auto unit = fresh()) return unit;
  return worker.units.empty() ? straggler_for(id) : std::nullopt;
}

std::optional<UnitId> Plan::suspect_for(WorkerId id) const {
  const auto found = std::ranges::find_if(suspects_, [&](const UnitId& candidate) {
    const Unit& unit = units_.at(candidate);
    return !unit.holders.contains(id) && !better_elsewhere(unit, id);
  });
  return found == suspects_.end() ? std::nullopt : std::optional(*found);
}

std::optional<UnitId> Plan::requeued_for(WorkerId id) const {
  const auto found = std::ranges::find_if(
      requeued_, [&](const UnitId& candidate) { return !units_.at(candidate).holders.contains(id); });
  return found == requeued_.end() ? std::nullopt : std::optional(*found);
}

std::optional<UnitId> Plan::fresh() {
  for (std::uint32_t i = 0; i < images_.size(); ++i) {
    Image& image = images_[i];
    if (image.next_pass >= image.passes || image.all.tiles == 0) continue;
    const UnitId unit{i, image.next_pass, image.next_tile};
    if (++image.next_tile == image.all.tiles) {
      image.next_tile = 0;
      ++image.next_pass;
    }
    return unit;
  }
  return {};
}

std::optional<UnitId> Plan::straggler_for(WorkerId id) {
  const Seconds straggler_age = timed_ == 0 ? kFirstStragglerAge : total_ / double(timed_);
  std::optional<UnitId> chosen;
  Seconds chosen_age = -1;
  for (const auto& [candidate, unit] : units_) {
    if (unit.closed || unit.holders.size() != 1 || unit.holders.contains(id) || !unit.faults.empty())
      continue;
    const Worker& holder = workers_.at(*unit.holders.begin());
    const bool in_hand = holder.units.front() == candidate;
    // One that has not been begun is the best to take over.
    const Seconds age = in_hand ? now_ - holder.in_hand_since : std::numeric_limits<Seconds>::infinity();
    if (age < straggler_age || age <= chosen_age) continue;
    chosen = candidate;
    chosen_age = age;
  }
  if (chosen) ++units_duplicated_;
  return chosen;
}

/// Whether the unit has failed on this worker while there is another one that it has not failed on.
bool Plan::better_elsewhere(const Unit& unit, WorkerId id) const {
  const auto failed_on = [&unit](WorkerId worker) {
    return std::ranges::any_of(unit.faults, [&](const auto& fault) { return fault.first == worker; });
  };
  if (!failed_on(id)) return false;
  return std::ranges::any_of(
      workers_, [&](const auto& other) { return !other.second.hung && !failed_on(other.first); });
}

bool Plan::rendered_by_someone(const Unit& unit) const {
  return std::ranges::any_of(unit.holders, [this](WorkerId holder) { return !workers_.at(holder).hung; });
}

// --- Who takes too long

/// A pause of the worker says nothing about how long parts of units take.
void Plan::show_progress(Worker& worker) {
  if (!worker.hung) longest_wait_ = std::max(longest_wait_, now_ - worker.progress_at);
  worker.hung = worker.overdue = false;
  worker.heard_at = worker.progress_at = now_;
}

/// Its lease begins now. A worker without a unit is not expected to report anything.
void Plan::take_in_hand(Worker& worker) {
  worker.in_hand_since = worker.progress_at = now_;
  if (worker.units.empty()) worker.heard_at = now_;
  worker.overdue = false;
}

void Plan::tell_if_overdue(WorkerId id, Worker& worker) {
  const Seconds since_heard = now_ - worker.heard_at, since_progress = now_ - worker.progress_at;
  const bool is_silent = since_heard >= leases_.patience;
  const bool is_slow = since_progress >= std::max(leases_.patience, 2 * longest_wait_);
  if (worker.overdue || (!is_silent && !is_slow)) return;
  worker.overdue = true;
  orders_.push_back(Overdue{id, worker.units.front(), is_silent, is_silent ? since_heard : since_progress,
                            hung_at(worker) - now_});
}

Plan::Lease Plan::lease(const Worker& worker) const {
  Seconds base = std::max(leases_.minimum, leases_.factor * longest_wait_);
  if (!worker.proven) base = std::max(base, leases_.initial);
  const double growth = std::pow(leases_.growth, units_.at(worker.units.front()).expired_leases);
  return {base * growth, leases_.silence * growth};
}

Seconds Plan::hung_at(const Worker& worker) const {
  const Lease given = lease(worker);
  return std::min(worker.progress_at + given.progress, worker.heard_at + given.silence);
}

}  // namespace penumbra
