// The events that the plan receives and the orders that it gives.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "worker/work_unit.h"

namespace penumbra {

/// Seconds of any monotonic clock.
using Seconds = double;

/// When a worker counts as hung. A unit's lease is the longest time that its worker may go without progress
/// (a part of the unit done, or all of it). It is `factor` times the longest such time so far, but at least
/// `minimum`. For a worker that has not finished a unit yet it is at least `initial`, because nothing is
/// known about the scene then, and giving up a slow worker is worse than waiting for one that hangs. A worker
/// that is not heard of at all for `silence`, although it should send a heartbeat every second, is stopped or
/// its machine is. Each time that a unit's lease has expired, its next lease is `growth` times longer, so
/// that a slow unit gets enough time. A worker that remains hung for the same time again is dismissed.
/// Whatever takes longer than `patience`, and than twice the longest time so far, is reported to the user.
struct LeaseRule {
  Seconds initial = 120;
  Seconds minimum = 30;
  double factor = 20;
  double growth = 3;
  Seconds silence = 10;
  Seconds patience = 5;
  // Timeouts of a worker that prepares a job: without a sign of life, and in total. They are slightly longer
  // than those of a starting process.
  Seconds unheard = 40, unprepared = 310;
};

constexpr int kUnitsPerWorker = 2;     ///< one being rendered, one waiting
constexpr int kFaultsToSetAside = 3;   ///< a unit with so many faults is left out of the image
constexpr int kFailuresToDismiss = 3;  ///< a worker is dismissed after so many failed units in a row
/// A job is given up after so many workers died in a row while preparing it.
constexpr int kDeathsToGiveUpJob = 3;
/// A job is given up after so many workers died at its units with none finished in between. Every present
/// worker may die of a unit before that is found out, and the scheduler must not stop starting workers
/// before.
constexpr int deaths_at_units_to_give_up_job(std::size_t workers) { return 4 * int(workers) + 3; }
constexpr int kDisputesToGiveUp = 3;  ///< after so many disputes between workers no result can be trusted
constexpr Seconds kFirstStragglerAge = 1;  ///< see Plan; used only until a unit of the job is finished

/// How long a unit waits for a second worker to verify it when everything else is done.
constexpr Seconds kTimeToFindASecond = 10;

constexpr int kJobsPerWorker = 2;  ///< prepared jobs that a worker keeps: the current one and the next
/// How far, for each worker, a submitter must lag behind others of equal priority before a worker forgets a
/// job of theirs and prepares one of its jobs. Preparing takes time.
constexpr double kLargestLag = 60;

constexpr std::uint32_t kAllPasses = ~std::uint32_t(0);

/// The work units of one phase of a job: tiles x passes.
struct PhaseUnits {
  std::uint32_t tiles = 0;
  std::uint32_t passes = 0;  ///< the largest number for a tile
  /// The number of passes of each tile until PassesOfTile increases it.
  std::uint32_t passes_at_first = kAllPasses;
  /// Only so many units, in issue order: pass by pass, tile by tile; nothing: all.
  std::optional<std::uint64_t> units_at_most = {};
  /// For each tile the number of passes that are already merged; empty: none.
  std::vector<std::uint32_t> merged = {};
  /// 1: units are issued pass by pass. More: the units of a pass share something that each worker makes
  /// itself, so a worker stays at its pass, and others work at up to so many passes side by side.
  std::uint32_t passes_at_once = 1;
};

/// What a worker did wrong with a unit.
enum class Fault {
  kDied,        ///< it was lost while rendering the unit
  kFailed,      ///< it reported that the unit cannot be rendered
  kHung,        ///< the unit's lease expired
  kCorrupt,     ///< its result was damaged in transfer
  kDisputed,    ///< its result differs from another worker's
  kUnprepared,  ///< it did not finish preparing a job
};

// --- Events

struct JobAdded {
  JobId job;
  /// Units of the job with the highest priority are issued first; among equals those of the submitter that
  /// has had the least time of workers, and of the same submitter the oldest job's.
  int priority = 0;
  std::vector<PhaseUnits> phases;
  /// The fraction of units that a second worker renders too, to compare the results. Which units those are
  /// depends only on their IDs.
  double verify = 0;
  std::string submitter = {};
};
/// The job is over, finished or not; nothing of it is needed any more.
struct JobRemoved {
  JobId job;
};
struct PriorityChanged {
  JobId job;
  int priority;
};
/// All issued units of the job are void. It starts again as it was added, but with nothing merged. Whoever
/// passes on events drops what workers still send for the old units.
struct JobRestarted {
  JobId job;
};
/// The results of the earlier phases are ready, so the phase may begin.
struct PhaseOpened {
  JobId job;
  std::uint32_t phase;
};
struct WorkerJoined {  ///< connected; not prepared for any job yet
  WorkerId worker;
};
struct WorkerPrepared {  ///< the worker is prepared for the job, as ordered
  WorkerId worker;
  JobId job;
};
struct WorkerUnfit {  ///< the worker cannot render the job at all
  WorkerId worker;
  JobId job;
};
struct WorkerLost {
  WorkerId worker;
  bool has_left = false;  ///< it ended voluntarily, so its current unit is not to blame
};
struct Alive {  ///< a sign of life of the worker
  WorkerId worker;
};
struct Progressed {  ///< the worker has finished a part of its current unit
  WorkerId worker;
};
struct UnitDone {
  WorkerId worker;
  UnitId unit;
  std::uint64_t hash;  ///< of the result, for comparison with a second one
};
struct UnitFailed {
  WorkerId worker;
  UnitId unit;
};
struct ResultCorrupt {  ///< the received data are not a valid result of this unit
  WorkerId worker;
  UnitId unit;
};
struct MorePasses {  ///< the new number of passes of the job's present phase; not less than before
  JobId job;
  std::uint32_t passes;
};
/// The new number of passes of a tile in the job's present phase; a smaller number has no effect.
struct PassesOfTile {
  JobId job;
  std::uint32_t tile;
  std::uint32_t passes;
};
/// For the job's last phase: issue no more units than are needed so that those issued, and at least those of
/// the first pass, are the first ones, pass by pass. Units merged by an earlier scheduler count as issued.
struct NoFurtherUnits {
  JobId job;
};
struct Tick {};  ///< time has passed

using PlanEvent = std::variant<JobAdded, JobRemoved, PriorityChanged, JobRestarted, PhaseOpened, WorkerJoined,
                               WorkerPrepared, WorkerUnfit, WorkerLost, Alive, Progressed, UnitDone,
                               UnitFailed, ResultCorrupt, MorePasses, PassesOfTile, NoFurtherUnits, Tick>;

// --- Orders, to be executed in this order.

struct Prepare {  ///< send the job to the worker; units follow when it is prepared
  WorkerId worker;
  JobId job;
};
struct Forget {  ///< the worker does not need the job any more
  WorkerId worker;
  JobId job;
};
struct Assign {
  WorkerId worker;
  UnitId unit;
};
struct MergeResult {  ///< the result of the event is the first one of its unit
  WorkerId worker;
  UnitId unit;
};
struct DiscardResult {  ///< the result of the event is not needed, or not trusted
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
  UnitId unit;                      ///< the unit concerned
  std::optional<WorkerId> accuser;  ///< for kDisputed: the worker that disagrees; it is dismissed too
};
/// Forget what was merged of the tile, because it contains untrusted results; all of it will be rendered
/// again.
struct RedoTile {
  JobId job;
  std::uint32_t phase;
  std::uint32_t tile;
};
struct PhaseDone {  ///< all units are done or set aside, and another phase waits for PhaseOpened
  JobId job;
  std::uint32_t phase;
};
/// Untrusted results went into a finished phase: forget everything about the job. It has started again, as by
/// JobRestarted.
struct RestartJob {
  JobId job;
};
/// Every present worker has said that it cannot render the job, or so many have died of it that no other one
/// should try.
struct NoCapableWorker {
  JobId job;
  int deaths = 0;
  bool at_units = false;  ///< they died at its units
};
struct UnitOverdue {  ///< to be reported to the user; once for each occurrence
  WorkerId worker;
  UnitId unit;         ///< the unit that it is rendering
  bool is_silent;      ///< no sign of life at all; else only no progress
  Seconds since;       ///< time since the last sign
  Seconds until_hung;  ///< time from now
};
struct GiveUp {};  ///< workers keep disagreeing, so no result can be trusted

using PlanOrder = std::variant<Prepare, Forget, Assign, MergeResult, DiscardResult, SetAside, DismissWorker,
                               RedoTile, PhaseDone, RestartJob, NoCapableWorker, UnitOverdue, GiveUp>;

}  // namespace penumbra
