// Which worker renders which unit, and what happens when a worker dies, hangs, is slow or returns wrong
// results. Pure: events in, orders out; no I/O, no threads, no clock, so that every rule can be tested with
// fake workers and a fake clock.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "scheduler/plan/plan_messages.h"

namespace penumbra {

/// The state of all jobs and workers of a scheduler. Rules:
/// - Jobs are ordered by priority, then by age. A worker gets units of the first job that has any for it. One
///   that does not know a job with work for it is told to prepare it, behind what it holds, and gets nothing
///   more until it has; it keeps up to kJobsPerWorker jobs, and prepares one in advance when it has nothing
///   else to do.
/// - A worker that cannot do a job beside others that it keeps is given it again without them. A job that no
///   worker can do, or that workers die of while they prepare it, is told; the others go on.
/// - Phases of a job follow each other: the next one waits for its PhaseOpened.
/// - Units are issued pass by pass. A worker has at most `kUnitsPerWorker`; only the first is in its hand.
/// - A unit that comes back unfinished (worker lost, dismissed or hung) is issued again before anything new
///   of its job. The unit in hand is blamed for it. A blamed unit is issued alone from then on, so that the
///   next blame cannot hit the wrong unit, and goes to a worker that it has not failed on while there is one.
///   Three faults set it aside.
/// - When nothing is left to issue, idle workers get copies of units that wait at a busy worker, or that have
///   been in hand for longer than the mean unit. The first result counts. A second one must have the same
///   hash: otherwise one of the two workers computes wrongly. It is not known which, so both are dismissed
///   and every tile that either worked on is done again from its first pass; a job with an earlier phase that
///   they worked on starts again.
/// - A late result of a unit that is still open counts like any other.
/// - Of a job that asks for it, a share of the units goes to a second worker as soon as the first one is done
///   with them, before anything new; the job is not finished before. Where nobody can be the second, they are
///   counted as not verified in the end.
/// No event but those of jobs takes a time that grows with the number of workers or units, except as their
/// logarithm: whoever can take something, what can be copied and when the next lease ends is kept in order.
class Plan {
 public:
  explicit Plan(LeaseRule leases = {});

  std::vector<PlanOrder> handle(const PlanEvent& event, Seconds now);

  /// Every unit of every job is done or set aside, of all phases, and verified where that was asked for.
  [[nodiscard]] bool finished() const {
    return units_left_ == 0 &&
           std::ranges::all_of(jobs_, [](const auto& job) { return job.second.unverified == 0; });
  }
  [[nodiscard]] bool finished(JobId job) const {
    return jobs_.at(job).units_left == 0 && jobs_.at(job).unverified == 0;
  }
  [[nodiscard]] bool gave_up() const { return disputes_ >= kDisputesToGiveUp; }
  [[nodiscard]] std::uint64_t units_left() const { return units_left_; }

  /// Of one job, since it was added or began anew. What was merged before counts as done.
  struct Counts {
    std::uint64_t done = 0, duplicated = 0, requeued = 0;  ///< duplicated: copies given out
    std::uint64_t verified = 0, not_verified = 0;          ///< of those that were to be
  };
  [[nodiscard]] Counts counts(JobId job) const { return jobs_.at(job).counts; }
  [[nodiscard]] const std::set<UnitId>& set_aside(JobId job) const { return jobs_.at(job).set_aside; }
  /// Passes of the present phase that will be rendered of a tile at most, as MorePasses and NoFurtherUnits
  /// left them; and of one tile.
  [[nodiscard]] std::uint32_t passes(JobId job) const { return present(jobs_.at(job)).passes; }
  [[nodiscard]] std::uint32_t passes(JobId job, std::uint32_t tile) const {
    return present(jobs_.at(job)).end(tile);
  }
  /// What the worker renders at the moment, as far as is known here.
  [[nodiscard]] std::optional<UnitId> in_hand(WorkerId worker) const;
  /// Whether any worker renders a unit of the job, likewise.
  [[nodiscard]] bool is_in_hand(JobId job) const;

 private:
  struct Phase {
    std::uint32_t tiles;
    std::uint32_t passes;                    // to be issued, at most
    bool by_tile;                            // each tile has its limit
    bool closed = false;                     // to further passes
    std::vector<std::uint32_t> next, limit;  // of each tile: the pass to be issued next, and where it ends
    std::vector<std::uint64_t> fresh;        // heap of (next, tile) of the tiles with anything to issue
    std::uint64_t left = 0;                  // units that are neither done nor set aside

    explicit Phase(const PhaseUnits& units);
    [[nodiscard]] std::uint32_t end(std::uint32_t tile) const { return std::min(limit[tile], passes); }
    [[nodiscard]] std::uint64_t units() const;  // of all tiles up to their ends
    void queue_tiles();
    void queue(std::uint32_t tile);
    [[nodiscard]] std::optional<std::pair<std::uint32_t, std::uint32_t>> take();  // a pass and its tile
  };
  struct Job {
    int priority = 0;
    std::vector<PhaseUnits> as_added;
    std::vector<Phase> phases;
    std::uint32_t phase = 0;
    bool waits = false;  // for the present phase to be opened
    std::uint64_t units_left = 0;
    Counts counts;
    std::set<UnitId> set_aside;
    // What its units take.
    Seconds longest_wait = 0;  // for a sign of progress
    Seconds total = 0;         // of finished units
    std::uint64_t timed = 0;
    int deaths = 0;           // of workers that were preparing it, one after the other
    int deaths_at_units = 0;  // likewise at units, since one was finished
    // What can be copied: units with one holder and no blame, by when they were begun (kNotBegun: not yet).
    std::set<std::pair<Seconds, UnitId>> copyable;
    // Units to be verified.
    double verify = 0;
    std::uint64_t unverified = 0;       // done so far, but not by a second worker
    std::set<UnitId> checks;            // of them, those that no second worker has
    std::optional<Seconds> idle_since;  // there is nothing but checks, and nobody takes them

    void begin();
  };
  struct Worker {
    std::deque<UnitId> units;  // the first is in hand
    Seconds in_hand_since = 0;
    Seconds heard_at = 0, progress_at = 0;  // last signs of life, and of progress at what is in hand
    std::set<JobId> prepared, unfit;
    std::optional<JobId> preparing;          // also one that was removed meanwhile: it is busy with it
    bool prepares_in_vain = false;           // that job has been added anew since
    std::optional<Seconds> preparing_since;  // with nothing in hand any more
    std::set<JobId> alone;                   // failed beside other jobs: to be tried without any
    std::set<JobId> proven;                  // of which it has finished a unit
    bool overdue = false;                    // which has been told
    int failures_in_a_row = 0;
    bool hung = false;                 // its lease expired and nothing came since
    bool silent = false;               // ... for silence
    Seconds hung_until = 0;            // then it is dismissed
    std::optional<std::size_t> wants;  // in which of idle_workers_ it is
  };
  // A unit that was issued and that a worker still holds, or that waits to be issued again or verified. A
  // unit before its tile's `next` that has no record is done or set aside.
  struct Unit {
    std::set<WorkerId> holders;
    bool closed = false;  // done or set aside; kept for the holders' results
    std::uint64_t hash = 0;
    std::optional<WorkerId> done_by;
    int expired_leases = 0;
    std::vector<std::pair<WorkerId, Fault>> faults;
    std::optional<Seconds> copyable;  // as it stands in its job's list
    bool unverified = false;          // closed, and another worker is to do it too
    int failed_checks = 0;
  };

  void on(const JobAdded& event);
  void on(const JobRemoved& event);
  void on(const PriorityChanged& event);
  void on(const JobRestarted& event);
  void on(const PhaseOpened& event);
  void on(const WorkerJoined& event);
  void on(const WorkerPrepared& event);
  void on(const WorkerUnfit& event);
  void on(const WorkerLost& event);
  void on(const Alive& event);
  void on(const Progressed& event);
  void on(const UnitDone& event);
  void on(const UnitFailed& event);
  void on(const ResultCorrupt& event);
  void on(const MorePasses& event);
  void on(const PassesOfTile& event);
  void on(const NoFurtherUnits& event);
  void on(const Tick& event);

  [[nodiscard]] static const Phase& present(const Job& job) { return job.phases[job.phase]; }
  [[nodiscard]] Phase& phase_of(UnitId id) { return jobs_.at(id.job).phases[id.phase]; }
  void order_jobs();
  void forget_units(JobId job);
  void restart(JobId job);
  void count_left(UnitId id, std::int64_t more);
  void count_left(Job& job, Phase& phase, std::int64_t more);
  void tell_if_phase_is_done(JobId id);
  void tell_if_nobody_can(JobId id);
  void forget_others(WorkerId id);

  bool take_back(WorkerId worker, UnitId id);
  void settle(UnitId id);
  void enqueue(UnitId id, const Unit& unit);
  void dequeue(UnitId id);
  void blame(UnitId id, WorkerId worker, Fault fault);
  void update_idle(UnitId id);
  void update_idle(WorkerId id, Worker& worker);
  void release(WorkerId worker);
  void dismiss(WorkerId worker, Fault fault, UnitId unit, std::optional<WorkerId> accuser = {});
  void accept(const UnitDone& event, Unit& unit);
  void dispute(const UnitDone& event, Unit& unit);
  void redo_work_of(WorkerId first, WorkerId second);
  void redo_work_of(WorkerId first, WorkerId second, JobId id);
  void reopen(UnitId id);
  [[nodiscard]] std::vector<bool>& contributions(WorkerId worker, JobId job, std::uint32_t phase);

  // In plan_verify.cpp.
  [[nodiscard]] bool is_to_be_verified(UnitId id) const;
  void end_check(UnitId id, Unit& unit);
  void give_up_checks(JobId id);
  [[nodiscard]] bool may_be_verified_later(JobId job) const;
  void give_up_idle_checks();
  [[nodiscard]] std::optional<UnitId> check_for(WorkerId worker, JobId job) const;

  // In plan_issue.cpp.
  void issue();
  void issue_to(WorkerId id);
  [[nodiscard]] bool is_anything_waiting(bool also_copies) const;
  std::optional<UnitId> next_for(WorkerId worker);
  [[nodiscard]] bool has_work(const Job& job, JobId id) const;
  void prepare_one(WorkerId id, bool in_advance);
  [[nodiscard]] bool make_room(WorkerId id);
  [[nodiscard]] std::optional<UnitId> suspect_for(WorkerId worker, JobId job) const;
  [[nodiscard]] std::optional<UnitId> requeued_for(WorkerId worker, JobId job) const;
  std::optional<UnitId> fresh(JobId job);
  std::optional<UnitId> straggler_for(WorkerId worker);
  [[nodiscard]] std::optional<std::pair<Seconds, UnitId>> oldest_straggler(const Job& job) const;
  [[nodiscard]] bool better_elsewhere(const Unit& unit, WorkerId worker, JobId job) const;
  [[nodiscard]] bool rendered_by_someone(const Unit& unit) const;
  void show_progress(Worker& worker);
  void take_in_hand(Worker& worker);
  void tell_if_overdue(WorkerId id, Worker& worker);
  [[nodiscard]] Seconds overdue_at(const Worker& worker) const;
  void look_after_workers();
  void look_by(Seconds time) { next_check_ = std::min(next_check_, time); }
  [[nodiscard]] bool is_stuck_preparing(Worker& worker) const;
  /// How long its unit in hand may go without progress, and the worker without a word.
  struct Lease {
    Seconds progress, silence;
  };
  [[nodiscard]] Lease lease(const Worker& worker) const;
  [[nodiscard]] Seconds hung_at(const Worker& worker) const;

  LeaseRule leases_;
  std::map<JobId, Job> jobs_;
  std::vector<JobId> order_;  // of jobs_, as units are taken from them
  std::map<WorkerId, Worker> workers_;
  std::map<UnitId, Unit> units_;
  std::set<UnitId> requeued_;  // to be issued again
  std::set<UnitId> suspects_;  // likewise, but blamed for something
  std::map<std::tuple<WorkerId, JobId, std::uint32_t>, std::vector<bool>>
      contributions_;  // tiles of a phase, also of lost workers

  // By how many units they hold: workers that can take another one.
  std::array<std::set<WorkerId>, kUnitsPerWorker> idle_workers_;
  // Of this event: who may prepare a job in advance now.
  std::vector<WorkerId> changed_;
  bool all_changed_ = false;

  Seconds now_ = 0;
  // No lease ends before, nor is anybody overdue; and the shortest time from a sign of life to either.
  Seconds next_check_ = 0, shortest_;
  std::uint64_t units_left_ = 0;
  int disputes_ = 0;
  std::vector<PlanOrder> orders_;
};

}  // namespace penumbra
