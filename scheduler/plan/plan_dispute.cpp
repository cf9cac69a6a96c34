// Handling of results, and of disputes, in which two results of one unit differ.
#include <algorithm>
#include <utility>

#include "scheduler/plan/plan.h"

namespace penumbra {

void Plan::accept(const UnitDone& event, Unit& unit) {
  unit.closed = true;
  unit.hash = event.hash;
  unit.done_by = event.worker;
  unit.failed_checks = 0;
  update_copyable(event.unit);
  if (is_to_be_verified(event.unit)) {
    unit.unverified = true;
    ++jobs_.at(event.unit.job).unverified;
  }
  dequeue(event.unit);
  count_left(event.unit, -1);
  Job& job = jobs_.at(event.unit.job);
  ++job.counts.done;
  job.deaths = job.deaths_at_units = 0;
  contributions(event.worker, event.unit.job, event.unit.phase)[event.unit.tile] = true;
  orders_.push_back(MergeResult{event.worker, event.unit});
  tell_if_phase_is_done(event.unit.job);
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

void Plan::redo_work_of(WorkerId first, WorkerId second) {
  for (const JobId id : order_) redo_work_of(first, second, id);
}

/// Chan's merge cannot be undone for one unit, so all tiles to which the two workers contributed start again.
/// The results of an earlier phase cannot be undone at all, so then the job starts again.
void Plan::redo_work_of(WorkerId first, WorkerId second, JobId id) {
  Job& job = jobs_.at(id);
  for (std::uint32_t phase = 0; phase < job.phase; ++phase) {
    if (!contributions_.contains({first, id, phase}) && !contributions_.contains({second, id, phase}))
      continue;
    orders_.push_back(RestartJob{id});
    restart(id);
    return;
  }
  const Phase& phase = present(job);
  const std::vector<bool> of_first = contributions(first, id, job.phase),
                          of_second = contributions(second, id, job.phase);
  for (std::uint32_t tile = 0; tile < phase.tiles; ++tile) {
    if (!of_first[tile] && !of_second[tile]) continue;
    orders_.push_back(RedoTile{id, job.phase, tile});
    for (std::uint32_t pass = 0; pass < phase.issued_end(tile); ++pass)
      if (phase.is_issued(pass, tile)) reopen({id, job.phase, pass, tile});
  }
  contributions_.erase({first, id, job.phase});
  contributions_.erase({second, id, job.phase});
}

void Plan::reopen(UnitId id) {
  if (jobs_.at(id.job).set_aside.contains(id)) return;
  const auto [found, is_new] = units_.try_emplace(id);
  Unit& unit = found->second;
  if (!is_new && !unit.closed) return;  // it is queued already
  end_check(id, unit);
  unit.closed = false;
  unit.done_by.reset();
  count_left(id, 1);
  --jobs_.at(id.job).counts.done;
  settle(id);
}

std::vector<bool>& Plan::contributions(WorkerId worker, JobId job, std::uint32_t phase) {
  std::vector<bool>& tiles = contributions_[{worker, job, phase}];
  tiles.resize(jobs_.at(job).phases[phase].tiles);
  return tiles;
}

}  // namespace penumbra
