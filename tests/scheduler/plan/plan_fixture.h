// A plan with fake workers and a fake clock, for tests of its rules.
#pragma once

#include <gmock/gmock.h>

#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "scheduler/plan/plan.h"

namespace penumbra {

// For readable failures.
inline void PrintTo(const UnitId& id, std::ostream* out) {
  *out << "unit(job " << id.job << ", phase " << id.phase << ", pass " << id.pass << ", tile " << id.tile
       << ")";
}

constexpr JobId kJob = 1;

constexpr UnitId unit(std::uint32_t pass, std::uint32_t tile, JobId job = kJob, std::uint32_t phase = 0) {
  return {.job = job, .phase = phase, .pass = pass, .tile = tile};
}

constexpr Seconds kNever = std::numeric_limits<Seconds>::infinity();

class PlanTest : public testing::Test {
 protected:
  void start(std::uint32_t tiles, std::uint32_t passes, LeaseRule leases = {.silence = kNever}) {
    plan_.emplace(leases);
    add(kJob, {{tiles, passes}});
  }
  void add(JobId job, std::vector<PhaseUnits> phases, int priority = 0) {
    tell(JobAdded{job, priority, std::move(phases)});
  }

  /// Workers are prepared as soon as they are told to be.
  void tell(const PlanEvent& event) {
    last_ = plan_->handle(event, now_);
    for (std::size_t i = 0; i < last_.size(); ++i) {
      const auto* prepare = std::get_if<Prepare>(&last_[i]);
      if (prepare == nullptr || !prepares_at_once_) continue;
      const auto more = plan_->handle(WorkerPrepared{prepare->worker, prepare->job}, now_);
      last_.insert(last_.end(), more.begin(), more.end());
    }
    for (const auto& [worker, id] : all<Assign, std::pair<WorkerId, UnitId>>(
             [](const Assign& a) { return std::pair(a.worker, a.unit); })) {
      held_[worker].push_back(id);
    }
  }
  void join(WorkerId worker) { tell(WorkerJoined{worker}); }
  void lose(WorkerId worker) {
    held_.erase(worker);
    tell(WorkerLost{worker});
  }
  void done(WorkerId worker, UnitId id, std::uint64_t hash = 7) {
    std::erase(held_[worker], id);
    tell(UnitDone{worker, id, hash});
  }
  void fails(WorkerId worker, UnitId id) {
    std::erase(held_[worker], id);
    tell(UnitFailed{worker, id});
  }
  void wait(Seconds seconds) {
    now_ += seconds;
    tell(Tick{});
  }
  /// The worker finishes what is in its hand, a second after the last event.
  void work(WorkerId worker) {
    now_ += 1;
    done(worker, held_[worker].front());
  }

  template <typename Order, typename Value>
  std::vector<Value> all(Value (*value)(const Order&)) const {
    std::vector<Value> found;
    for (const PlanOrder& order : last_) {
      if (const Order* o = std::get_if<Order>(&order)) found.push_back(value(*o));
    }
    return found;
  }
  std::vector<std::pair<WorkerId, UnitId>> assigned() const {
    return all<Assign, std::pair<WorkerId, UnitId>>(
        [](const Assign& a) { return std::pair(a.worker, a.unit); });
  }
  std::vector<UnitId> merged() const {
    return all<MergeResult, UnitId>([](const MergeResult& m) { return m.unit; });
  }
  std::vector<UnitId> discarded() const {
    return all<DiscardResult, UnitId>([](const DiscardResult& d) { return d.unit; });
  }
  std::vector<UnitId> set_aside() const {
    return all<SetAside, UnitId>([](const SetAside& s) { return s.unit; });
  }
  std::vector<std::pair<WorkerId, Fault>> dismissed() const {
    return all<DismissWorker, std::pair<WorkerId, Fault>>(
        [](const DismissWorker& d) { return std::pair(d.worker, d.fault); });
  }
  std::vector<std::uint32_t> tiles_to_redo() const {
    return all<RedoTile, std::uint32_t>([](const RedoTile& r) { return r.tile; });
  }

  std::optional<Plan> plan_;
  bool prepares_at_once_ = true;
  Seconds now_ = 100;
  std::vector<PlanOrder> last_;
  std::map<WorkerId, std::vector<UnitId>> held_;
};

}  // namespace penumbra
