// What the plan is told, and what it orders.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "scheduler/plan/work_unit.h"

namespace penumbra {

/// Any monotonic time, in seconds.
using Seconds = double;

/// How long a worker may go without a sign of progress at its unit (a part of it done, or all of it) before
/// it counts as hung: `factor` times the longest that any took so far, at least `minimum`; at least `initial`
/// for a worker that has not finished a unit yet, because nothing is known about the scene then and giving up
/// a worker that is merely slow is worse than waiting for one that hangs. One that is not heard of at all for
/// `silence`, while it should say every second that it is alive, is stopped, or its machine is. Each time
/// that a unit's lease has expired its next one is `growth` times longer, so a unit that is slow gets its
/// time. A worker that goes on like that for as long again is dismissed. What takes longer than `patience`,
/// and than twice the longest so far, is told to the user.
struct LeaseRule {
  Seconds initial = 120;
  Seconds minimum = 30;
  double factor = 20;
  double growth = 3;
  Seconds silence = 10;
  Seconds patience = 5;
  // Of one that prepares a job: without a word, and in all. A little longer than what a starting process has.
  Seconds unheard = 40, unprepared = 310;
};

constexpr int kUnitsPerWorker = 2;     ///< one in hand, one on the way
constexpr int kFaultsToSetAside = 3;   ///< a unit that failed so often is left out
constexpr int kFailuresToDismiss = 3;  ///< so many failed units one after the other, and the worker goes
constexpr int kDeathsToGiveUpJob = 3;  ///< of workers that were preparing it, and none was ready in between
/// Deaths of workers at units of a job, with none finished in between, after which it is given up. Each
/// worker that is there may die of a unit until that is found out; and a scheduler does not give up starting
/// workers before.
constexpr int deaths_at_units_to_give_up_job(std::size_t workers) { return 4 * int(workers) + 3; }
constexpr int kDisputesToGiveUp = 3;  ///< so many pairs of workers that disagreed, and none can be trusted
constexpr Seconds kFirstStragglerAge = 1;  ///< see Plan; only while no unit of the job is finished

constexpr Seconds kTimeToFindASecond = 10;  ///< for a unit that is to be verified, when all else is done

constexpr int kJobsPerWorker = 2;  ///< that it keeps prepared: the one it works at, and the next

constexpr std::uint32_t kAllPasses = ~std::uint32_t(0);
constexpr std::uint64_t kAllUnits = ~std::uint64_t(0);

/// The work units of one phase of a job: tiles x passes.
struct PhaseUnits {
  std::uint32_t tiles = 0;
  std::uint32_t passes = 0;  ///< of a tile, at most
  /// Of each tile so many, from the first, before PassesOfTile says more.
  std::uint32_t passes_at_first = kAllPasses;
  /// So many units, the first in the order in which they are issued: pass by pass, tile by tile.
  std::uint64_t units_at_most = kAllUnits;
  /// Of each tile so many, from the first, are there already; empty: none.
  std::vector<std::uint32_t> merged = {};
};

/// What a worker did to a unit.
enum class Fault {
  kDied,        ///< it was lost with the unit in hand
  kFailed,      ///< it reported that the unit cannot be rendered
  kHung,        ///< the unit's lease expired
  kCorrupt,     ///< its result was damaged
  kDisputed,    ///< its result has other bytes than another worker's
  kUnprepared,  ///< it did not come to an end with preparing a job
};

// --- Events: what happened.

struct JobAdded {
  JobId job;
  int priority = 0;  ///< of two jobs with work for a worker, that with the higher one; then the older one
  std::vector<PhaseUnits> phases;
  /// Of its units, the share that a second worker does too, to compare the results; which ones they are is a
  /// function of their names alone.
  double verify = 0;
};
/// It is over, finished or not; nothing of it is wanted any more.
struct JobRemoved {
  JobId job;
};
struct PriorityChanged {
  JobId job;
  int priority;
};
/// What was issued of it is void: it begins anew, as it was added, but with nothing merged. What workers
/// still do of it is dropped by those who pass on events.
struct JobRestarted {
  JobId job;
};
/// What its earlier phases made is at hand: the phase may begin.
struct PhaseOpened {
  JobId job;
  std::uint32_t phase;
};
struct WorkerJoined {  ///< connected; knows no job yet
  WorkerId worker;
};
struct WorkerPrepared {  ///< it can render units of the job, as was ordered
  WorkerId worker;
  JobId job;
};
struct WorkerUnfit {  ///< it cannot do the job at all
  WorkerId worker;
  JobId job;
};
struct WorkerLost {
  WorkerId worker;
  bool has_left = false;  ///< by its own will: the unit in its hand is not to blame
};
struct Alive {  ///< the worker has sent a sign of life
  WorkerId worker;
};
struct Progressed {  ///< it has done a part of the unit in its hand
  WorkerId worker;
};
struct UnitDone {
  WorkerId worker;
  UnitId unit;
  std::uint64_t hash;  ///< of the result, to compare it with a second one
};
struct UnitFailed {
  WorkerId worker;
  UnitId unit;
};
struct ResultCorrupt {  ///< the received data is not a valid result of this unit
  WorkerId worker;
  UnitId unit;
};
struct MorePasses {  ///< of the job's present phase: so many in all; no fewer than before
  JobId job;
  std::uint32_t passes;
};
struct PassesOfTile {  ///< of a tile of the job's present phase: so many in all; fewer than before change
                       ///< nothing
  JobId job;
  std::uint32_t tile;
  std::uint32_t passes;
};
/// Of the job's last phase: issue no more units than make those that were issued, and at least those of the
/// first pass, the first ones of their order. What an earlier scheduler merged counts as issued.
struct NoFurtherUnits {
  JobId job;
};
struct Tick {};  ///< time has passed

using PlanEvent = std::variant<JobAdded, JobRemoved, PriorityChanged, JobRestarted, PhaseOpened, WorkerJoined,
                               WorkerPrepared, WorkerUnfit, WorkerLost, Alive, Progressed, UnitDone,
                               UnitFailed, ResultCorrupt, MorePasses, PassesOfTile, NoFurtherUnits, Tick>;

// --- Orders: what to do, in this order.

struct Prepare {  ///< the worker gets the job; units follow when it has said that it is prepared
  WorkerId worker;
  JobId job;
};
struct Forget {  ///< the worker needs the job no longer
  WorkerId worker;
  JobId job;
};
struct Assign {
  WorkerId worker;
  UnitId unit;
};
struct MergeResult {  ///< the result that the event brought is the first of its unit
  WorkerId worker;
  UnitId unit;
};
struct DiscardResult {  ///< the result that the event brought is not needed, or not to be trusted
  WorkerId worker;
  UnitId unit;
};
struct SetAside {  ///< the unit will never come
  UnitId unit;
  std::vector<std::pair<WorkerId, Fault>> faults;
};
struct DismissWorker {
  WorkerId worker;
  Fault fault;                      ///< why
  UnitId unit;                      ///< the unit at which it showed
  std::optional<WorkerId> accuser;  ///< kDisputed: the worker that disagrees; it is dismissed as well
};
struct RedoTile {  ///< forget what was merged of it: untrustworthy work went in, and all of it comes again
  JobId job;
  std::uint32_t phase;
  std::uint32_t tile;
};
struct PhaseDone {  ///< all its units are done or set aside, and another phase waits for PhaseOpened
  JobId job;
  std::uint32_t phase;
};
/// Untrustworthy work went into a phase that is over: forget all of the job. It has begun anew, as by
/// JobRestarted.
struct RestartJob {
  JobId job;
};
/// Every worker that is there has said that it cannot do the job; or so many have died of it that no other
/// one should try.
struct NoCapableWorker {
  JobId job;
  int deaths = 0;
  bool at_units = false;  ///< they died of its units
};
struct UnitOverdue {  ///< people should know what is waited for; once for each time that it happens
  WorkerId worker;
  UnitId unit;         ///< in its hand
  bool is_silent;      ///< it is not heard of at all; else it shows no progress
  Seconds since;       ///< its last sign
  Seconds until_hung;  ///< from now
};
struct GiveUp {};  ///< workers keep disagreeing; no result can be trusted

using PlanOrder = std::variant<Prepare, Forget, Assign, MergeResult, DiscardResult, SetAside, DismissWorker,
                               RedoTile, PhaseDone, RestartJob, NoCapableWorker, UnitOverdue, GiveUp>;

}  // namespace penumbra
