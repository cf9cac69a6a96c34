// Which worker renders which unit, and what happens when a worker dies, hangs, is slow or returns wrong
// results. Pure: events in, orders out; no I/O, no threads, no clock, so that every rule can be tested with
// fake workers and a fake clock.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
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
};

constexpr int kUnitsPerWorker = 2;     ///< one in hand, one on the way
constexpr int kFaultsToSetAside = 3;   ///< a unit that failed so often is left out
constexpr int kFailuresToDismiss = 3;  ///< so many failed units one after the other, and the worker goes
constexpr int kDisputesToGiveUp = 3;   ///< so many pairs of workers that disagreed, and none can be trusted
constexpr Seconds kFirstStragglerAge = 1;  ///< see Plan; only while no unit is finished

/// The work units of one image: tiles x passes.
struct ImageUnits {
  std::uint32_t tiles = 0;
  std::uint32_t passes = 0;
};

/// What a worker did to a unit.
enum class Fault {
  kDied,      ///< it was lost with the unit in hand
  kFailed,    ///< it reported that the unit cannot be rendered
  kHung,      ///< the unit's lease expired
  kCorrupt,   ///< its result was damaged
  kDisputed,  ///< its result has other bytes than another worker's
};

// --- Events: what happened.

struct WorkerJoined {  ///< ready to render
  WorkerId worker;
};
struct WorkerLost {
  WorkerId worker;
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
struct MorePasses {  ///< so many in all; no fewer than before
  std::uint32_t image;
  std::uint32_t passes;
};
struct NoFurtherPasses {};  ///< finish the passes that are begun (the first one at least), then stop
struct Tick {};             ///< time has passed

using PlanEvent = std::variant<WorkerJoined, WorkerLost, Alive, Progressed, UnitDone, UnitFailed,
                               ResultCorrupt, MorePasses, NoFurtherPasses, Tick>;

// --- Orders: what to do, in this order.

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
  std::uint32_t image;
  std::uint32_t tile;
};
struct Overdue {  ///< people should know what is waited for; once for each time that it happens
  WorkerId worker;
  UnitId unit;         ///< in its hand
  bool is_silent;      ///< it is not heard of at all; else it shows no progress
  Seconds since;       ///< its last sign
  Seconds until_hung;  ///< from now
};
struct GiveUp {};  ///< workers keep disagreeing; no result can be trusted

using PlanOrder =
    std::variant<Assign, MergeResult, DiscardResult, SetAside, DismissWorker, RedoTile, Overdue, GiveUp>;

/// The state of a run. Rules:
/// - Units are issued pass by pass. A worker has at most `kUnitsPerWorker`; only the first is in its hand.
/// - A unit that comes back unfinished (worker lost, dismissed or hung) is issued again before anything new.
///   The unit in hand is blamed for it. A blamed unit is issued alone from then on, so that the next blame
///   cannot hit the wrong unit, and goes to a worker that it has not failed on while there is one. Three
///   faults set it aside.
/// - When nothing is left to issue, idle workers get copies of units that wait at a busy worker, or that have
///   been in hand for longer than the mean unit. The first result counts. A second one must have the same
///   hash: otherwise one of the two workers computes wrongly. It is not known which, so both are dismissed
///   and every tile that either worked on is done again from its first pass.
/// - A late result of a unit that is still open counts like any other.
class Plan {
 public:
  explicit Plan(std::vector<ImageUnits> images, LeaseRule leases = {});

  std::vector<PlanOrder> handle(const PlanEvent& event, Seconds now);

  /// Every unit is done or set aside.
  [[nodiscard]] bool finished() const { return units_left_ == 0; }
  [[nodiscard]] bool gave_up() const { return disputes_ >= kDisputesToGiveUp; }
  [[nodiscard]] std::uint64_t units_left() const { return units_left_; }
  [[nodiscard]] std::uint64_t units_done() const { return units_total_ - units_left_ - set_aside_.size(); }
  [[nodiscard]] std::uint64_t units_duplicated() const { return units_duplicated_; }  ///< copies given out
  [[nodiscard]] std::uint64_t units_requeued() const { return units_requeued_; }
  /// What the worker renders at the moment, as far as is known here.
  [[nodiscard]] std::optional<UnitId> in_hand(WorkerId worker) const;
  [[nodiscard]] const std::set<UnitId>& set_aside() const { return set_aside_; }
  /// Passes of an image that will be rendered, as MorePasses and NoFurtherPasses left them.
  [[nodiscard]] std::uint32_t passes(std::uint32_t image) const { return images_[image].passes; }

 private:
  struct Image {
    ImageUnits all;
    std::uint32_t passes;  // to be issued
    std::uint32_t next_pass = 0, next_tile = 0;
  };
  struct Worker {
    std::deque<UnitId> units;  // the first is in hand
    Seconds in_hand_since = 0;
    Seconds heard_at = 0, progress_at = 0;  // last signs of life, and of progress at what is in hand
    bool proven = false;                    // has finished a unit
    bool overdue = false;                   // which has been told
    int failures_in_a_row = 0;
    bool hung = false;       // its lease expired and nothing came since
    bool silent = false;     // ... for silence
    Seconds hung_until = 0;  // then it is dismissed
  };
  // A unit that was issued and that a worker still holds, or that waits to be issued again. A unit before its
  // image's `next` that has no record is done or set aside.
  struct Unit {
    std::set<WorkerId> holders;
    bool closed = false;  // done or set aside; kept for the holders' results
    std::uint64_t hash = 0;
    std::optional<WorkerId> done_by;
    int expired_leases = 0;
    std::vector<std::pair<WorkerId, Fault>> faults;
  };
  using Records = std::map<UnitId, Unit>;

  void on(const WorkerJoined& event);
  void on(const WorkerLost& event);
  void on(const Alive& event);
  void on(const Progressed& event);
  void on(const UnitDone& event);
  void on(const UnitFailed& event);
  void on(const ResultCorrupt& event);
  void on(const MorePasses& event);
  void on(const NoFurtherPasses& event);
  void on(const Tick& event);

  bool take_back(WorkerId worker, UnitId id);
  void settle(UnitId id);
  void enqueue(UnitId id, const Unit& unit);
  void dequeue(UnitId id);
  void blame(UnitId id, WorkerId worker, Fault fault);
  void release(WorkerId worker);
  void dismiss(WorkerId worker, Fault fault, UnitId unit, std::optional<WorkerId> accuser = {});
  void accept(const UnitDone& event, Unit& unit);
  void dispute(const UnitDone& event, Unit& unit);
  void redo_work_of(WorkerId first, WorkerId second);
  void reopen(UnitId id);

  void issue();
  std::optional<UnitId> next_for(WorkerId worker);
  [[nodiscard]] std::optional<UnitId> suspect_for(WorkerId worker) const;
  [[nodiscard]] std::optional<UnitId> requeued_for(WorkerId worker) const;
  std::optional<UnitId> fresh();
  std::optional<UnitId> straggler_for(WorkerId worker);
  [[nodiscard]] bool better_elsewhere(const Unit& unit, WorkerId worker) const;
  [[nodiscard]] bool rendered_by_someone(const Unit& unit) const;
  void show_progress(Worker& worker);
  void take_in_hand(Worker& worker);
  void tell_if_overdue(WorkerId id, Worker& worker);
  /// How long its unit in hand may go without progress, and the worker without a word.
  struct Lease {
    Seconds progress, silence;
  };
  [[nodiscard]] Lease lease(const Worker& worker) const;
  [[nodiscard]] Seconds hung_at(const Worker& worker) const;
  [[nodiscard]] std::vector<bool>& contributions(WorkerId worker, std::uint32_t image);

  LeaseRule leases_;
  std::vector<Image> images_;
  std::map<WorkerId, Worker> workers_;
  Records units_;
  std::set<UnitId> requeued_;  // to be issued again
  std::set<UnitId> suspects_;  // likewise, but blamed for something
  std::set<UnitId> set_aside_;
  std::map<std::pair<WorkerId, std::uint32_t>, std::vector<bool>>
      contributions_;  // tiles, also of lost workers

  Seconds now_ = 0;
  Seconds longest_wait_ = 0;  // for a sign of progress
  Seconds total_ = 0;         // of finished units
  std::uint64_t timed_ = 0;
  std::uint64_t units_total_ = 0, units_left_ = 0, units_duplicated_ = 0, units_requeued_ = 0;
  int disputes_ = 0;
  std::vector<PlanOrder> orders_;
};

}  // namespace penumbra
