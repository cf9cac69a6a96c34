// Decides which worker renders which unit, and what happens when a worker dies, hangs, is slow or returns
// wrong results. It is a pure state machine: events in, orders out. It has no I/O, threads or clock, so every
// rule can be tested with simulated workers and time.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "scheduler/plan/plan_messages.h"

namespace penumbra {

/// The state of all jobs and workers of a scheduler. Its rules:
///   - Jobs are ordered by priority, then by the time that workers have spent for their submitters while they
///     had jobs, so that submitters have equal shares; then by age. A worker gets units of the first job that
///     has any for it. A worker that is not prepared for a job with work for it is told to prepare it after
///     its current units. It gets nothing more until it is prepared. It keeps up to kJobsPerWorker jobs, and
///     prepares one in advance when it has nothing else to do.
///   - If a worker fails to prepare a job while it keeps others, it is told to try again without them. A job
///     that no worker can render, or whose preparation kills workers, is reported; the others go on.
///   - The phases of a job are sequential: each waits for its PhaseOpened.
///   - Units are issued pass by pass. A worker has at most `kUnitsPerWorker`, of which it renders the first.
///     With PhaseUnits::passes_at_once, a worker gets new units of the pass of its last unit; when there are
///     none left, of the pass at which the fewest workers are.
///   - A unit that was not finished (its worker was lost, dismissed or hung) is issued again before new units
///     of its job. The unit that the worker was rendering is blamed. A blamed unit is issued alone from then
///     on, so that the next blame cannot hit the wrong unit. It goes to a worker that has not failed on it,
///     if there is one. After three faults it is set aside.
///   - When there is nothing left to issue, idle workers get copies of units that wait at a busy worker, or
///     that have been rendering for longer than the mean unit. The first result is used. A second one must
///     have the same hash; otherwise one of the two workers computes wrongly. It is not known which one, so
///     both are dismissed, and every tile to which either contributed is rendered again from its first pass.
///     If they contributed to an earlier phase of a job, that job starts again.
///   - A late result of a unit that is still open is used like any other.
///   - If a job asks for verification, a fraction of its units goes to a second worker as soon as the first
///     one has finished them, before new units. The job is not finished before that. Units for which there is
///     no second worker are counted as not verified in the end.
/// Apart from events about jobs, handling an event takes at most logarithmic time in the number of workers
/// and units: idle workers, units to copy and lease deadlines are kept in sorted order.
class Plan {
 public:
  explicit Plan(LeaseRule leases = {});

  std::vector<PlanOrder> handle(const PlanEvent& event, Seconds now);

  /// Whether every unit of every phase of every job is done or set aside, and verified where that was asked
  /// for.
  [[nodiscard]] bool finished() const {
    return units_left_ == 0 &&
           std::ranges::all_of(jobs_, [](const auto& job) { return job.second.unverified == 0; });
  }
  [[nodiscard]] bool finished(JobId job) const {
    return jobs_.at(job).units_left == 0 && jobs_.at(job).unverified == 0;
  }
  [[nodiscard]] bool gave_up() const { return disputes_ >= kDisputesToGiveUp; }
  [[nodiscard]] std::uint64_t units_left() const { return units_left_; }

  /// Counts of a job since it was added or restarted. Units merged before (by another process) count as done.
  struct Counts {
    std::uint64_t done = 0, duplicated = 0, requeued = 0;  ///< duplicated: copies issued to idle workers
    std::uint64_t verified = 0, not_verified = 0;          ///< of the units chosen for verification
  };
  [[nodiscard]] Counts counts(JobId job) const { return jobs_.at(job).counts; }
  [[nodiscard]] const std::set<UnitId>& set_aside(JobId job) const { return jobs_.at(job).set_aside; }
  /// The largest number of passes of a tile in the present phase, after MorePasses and NoFurtherUnits; and
  /// the number for one tile.
  [[nodiscard]] std::uint32_t passes(JobId job) const { return present(jobs_.at(job)).passes; }
  [[nodiscard]] std::uint32_t passes(JobId job, std::uint32_t tile) const {
    return present(jobs_.at(job)).end(tile);
  }
  /// The unit that the worker is rendering, as far as is known.
  [[nodiscard]] std::optional<UnitId> in_hand(WorkerId worker) const;
  /// Whether any worker is rendering a unit of the job, as far as is known.
  [[nodiscard]] bool is_in_hand(JobId job) const;

 private:
  struct Phase {
    std::uint32_t tiles;
    std::uint32_t passes;                    // the largest number of passes to be issued
    bool by_tile;                            // each tile has its own limit
    bool closed = false;                     // no further passes are accepted
    std::uint32_t at_once;                   // passes that may be issued side by side
    std::vector<std::uint32_t> next, limit;  // for each tile: the first pass not issued, and the end
    // Units that may be issued now, as (pass, tile): of each tile those from `next` to `queued`, except the
    // ones that have been issued.
    std::vector<std::uint32_t> queued;
    std::set<std::pair<std::uint32_t, std::uint32_t>> fresh;
    std::uint64_t left = 0;  // number of units that are neither done nor set aside

    explicit Phase(const PhaseUnits& units);
    [[nodiscard]] std::uint32_t end(std::uint32_t tile) const { return std::min(limit[tile], passes); }
    [[nodiscard]] std::uint64_t units() const;  // the number of units of all tiles up to their limits
    [[nodiscard]] bool is_issued(std::uint32_t pass, std::uint32_t tile) const {
      return pass < next[tile] || (pass < queued[tile] && !fresh.contains({pass, tile}));
    }
    // The end of the passes of which a unit was issued.
    [[nodiscard]] std::uint32_t issued_end(std::uint32_t tile) const;
    void queue_tiles();
    void queue(std::uint32_t tile);
    void take(std::uint32_t pass, std::uint32_t tile);
  };
  struct Job {
    int priority = 0;
    std::string submitter;
    std::vector<PhaseUnits> as_added;
    std::vector<Phase> phases;
    std::uint32_t phase = 0;
    bool waits = false;  // waits for the present phase to be opened
    std::uint64_t units_left = 0;
    Counts counts;
    std::set<UnitId> set_aside;
    // Durations of its units.
    Seconds longest_wait = 0;  // the longest time to a sign of progress
    Seconds total = 0;         // the total time of finished units
    std::uint64_t timed = 0;
    int deaths = 0;           // number of workers lost in a row while preparing the job
    int deaths_at_units = 0;  // number of workers lost at its units since a unit was finished
    // Units that can be copied: those with one holder and no blame, sorted by their start (kNotBegun: not
    // started).
    std::set<std::pair<Seconds, UnitId>> copyable;
    // Verification of units.
    double verify = 0;
    std::uint64_t unverified = 0;       // units done so far, but not by a second worker
    std::set<UnitId> checks;            // those of them that are not issued to a second worker
    std::optional<Seconds> idle_since;  // since when only verifications are left and no worker takes them

    void begin();
    [[nodiscard]] Seconds expected() const { return timed > 0 ? total / Seconds(timed) : 1; }  // of a unit
  };
  struct Worker {
    std::deque<UnitId> units;  // the first is being rendered
    Seconds in_hand_since = 0;
    // Times of the last sign of life and of the last progress of the current unit.
    Seconds heard_at = 0, progress_at = 0;
    std::set<JobId> prepared, unfit;
    // Possibly a job that was removed meanwhile; the worker is still busy with it.
    std::optional<JobId> preparing;
    bool prepares_in_vain = false;           // that job has been added again since
    std::optional<Seconds> preparing_since;  // since when it prepares with no unit left
    std::set<JobId> alone;                   // jobs that failed beside other jobs, to be tried again alone
    std::set<JobId> proven;                  // jobs of which it has finished a unit
    bool overdue = false;                    // whether that it is overdue was reported
    int failures_in_a_row = 0;
    bool hung = false;                 // its lease expired and it has given no sign since
    bool silent = false;               // hung because of silence
    Seconds hung_until = 0;            // when it will be dismissed
    std::optional<std::size_t> wants;  // index into idle_workers_ of the set that contains it
    std::optional<UnitId> place;       // the pass of the last unit that it got, as its first unit
  };
  // A unit that was issued, and that a worker still holds or that waits to be issued again or verified. An
  // issued unit without such a record is done or set aside.
  struct Unit {
    std::set<WorkerId> holders;
    bool closed = false;  // done or set aside; kept for results of its remaining holders
    std::uint64_t hash = 0;
    std::optional<WorkerId> done_by;
    int expired_leases = 0;
    std::vector<std::pair<WorkerId, Fault>> faults;
    std::optional<Seconds> copyable;  // its key in the job's `copyable`
    bool unverified = false;          // closed, but still to be done by a second worker
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
  void add_submitter(const std::string& submitter);
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
  void update_copyable(UnitId id);
  void update_idle(WorkerId id, Worker& worker);
  void release(WorkerId worker);
  void dismiss(WorkerId worker, Fault fault, UnitId unit, std::optional<WorkerId> accuser = {});
  void accept(const UnitDone& event, Unit& unit);
  void dispute(const UnitDone& event, Unit& unit);
  void redo_work_of(WorkerId first, WorkerId second);
  void redo_work_of(WorkerId first, WorkerId second, JobId id);
  void reopen(UnitId id);
  [[nodiscard]] std::vector<bool>& contributions(WorkerId worker, JobId job, std::uint32_t phase);

  // Defined in plan_verify.cpp.
  [[nodiscard]] bool is_to_be_verified(UnitId id) const;
  void end_check(UnitId id, Unit& unit);
  void give_up_checks(JobId id);
  [[nodiscard]] bool may_be_verified_later(JobId job) const;
  void give_up_idle_checks();
  [[nodiscard]] std::optional<UnitId> check_for(WorkerId worker, JobId job) const;

  // Defined in plan_issue.cpp.
  void issue();
  void issue_to(WorkerId id);
  [[nodiscard]] bool is_anything_waiting(bool also_copies) const;
  std::optional<UnitId> next_for(WorkerId worker);
  [[nodiscard]] bool has_suspect(const Worker& worker) const;
  [[nodiscard]] bool has_work(const Job& job, JobId id) const;
  void prepare_one(WorkerId id, bool in_advance);
  [[nodiscard]] bool is_worth_forgetting_another(const Worker& worker, const Job& job) const;
  [[nodiscard]] bool make_room(WorkerId id);
  [[nodiscard]] std::optional<UnitId> suspect_for(WorkerId worker, JobId job) const;
  [[nodiscard]] std::optional<UnitId> requeued_for(WorkerId worker, JobId job) const;
  std::optional<UnitId> fresh_for(const Worker& worker, JobId job);
  [[nodiscard]] std::uint32_t pass_for(const Worker& worker, JobId job) const;
  void move_to(Worker& worker, std::optional<UnitId> unit);
  std::optional<UnitId> straggler_for(WorkerId worker);
  [[nodiscard]] std::optional<std::pair<Seconds, UnitId>> oldest_straggler(const Job& job) const;
  [[nodiscard]] bool better_elsewhere(const Unit& unit, WorkerId worker, JobId job) const;
  [[nodiscard]] bool rendered_by_someone(const Unit& unit) const;
  void show_progress(Worker& worker);
  void start_lease(Worker& worker);
  void tell_if_overdue(WorkerId id, Worker& worker);
  [[nodiscard]] Seconds overdue_at(const Worker& worker) const;
  void check_leases();
  void check_by(Seconds time) { next_check_ = std::min(next_check_, time); }
  [[nodiscard]] bool is_stuck_preparing(Worker& worker) const;
  /// How long a worker may go without progress of its current unit, and without any sign of life.
  struct Lease {
    Seconds progress, silence;
  };
  [[nodiscard]] Lease lease(const Worker& worker) const;
  [[nodiscard]] Seconds hung_at(const Worker& worker) const;

  LeaseRule leases_;
  std::map<JobId, Job> jobs_;
  std::vector<JobId> order_;  // keys of jobs_ in the order in which units are taken from them
  std::map<std::string, Seconds>
      spent_;  // time of workers for each submitter with jobs, expected when a unit is issued
  std::map<WorkerId, Worker> workers_;
  std::map<UnitId, Unit> units_;
  std::set<UnitId> requeued_;         // units to be issued again
  std::set<UnitId> suspects_;         // those of them that are blamed for a fault
  std::map<UnitId, int> workers_at_;  // for each pass, named by its first unit: the workers whose place it is
  std::map<std::tuple<WorkerId, JobId, std::uint32_t>, std::vector<bool>>
      contributions_;  // the tiles of a phase to which each worker contributed, including lost workers

  // Workers that can take another unit, by the number of units that they hold.
  std::array<std::set<WorkerId>, kUnitsPerWorker> idle_workers_;
  // Workers that this event allows to prepare a job in advance.
  std::vector<WorkerId> changed_;
  bool all_changed_ = false;

  Seconds now_ = 0;
  // No lease expires, and no worker becomes overdue, before next_check_. shortest_: the shortest time from a
  // sign of life to either.
  Seconds next_check_ = 0, shortest_;
  std::uint64_t units_left_ = 0;
  int disputes_ = 0;
  std::vector<PlanOrder> orders_;
};

}  // namespace penumbra
