// Simulates thousands of workers in simulated time: with the plan alone, and with a scheduler that handles
// one result after the other and needs a fixed time for each. tests/load/README.md computes what to expect;
// this test checks it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <iostream>
#include <map>
#include <queue>
#include <random>
#include <variant>
#include <vector>

#include "scheduler/plan/plan.h"

namespace penumbra {
namespace {

constexpr double kSpread = 0.2;  // of what units take, both ways

/// Whatever is asked of it takes `service` seconds, one after the other.
class SerialServer {
 public:
  explicit SerialServer(Seconds service) : service_(service) {}
  Seconds done_at(Seconds asked) { return free_at_ = std::max(free_at_, asked) + service_; }

 private:
  Seconds service_, free_at_ = 0;
};

/// Events in the order of their times.
template <typename Event>
class Timeline {
 public:
  void add(Seconds at, Event event) { entries_.push({at, next_++, event}); }
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  std::pair<Seconds, Event> next() {
    const Entry entry = entries_.top();
    entries_.pop();
    return {entry.at, entry.event};
  }

 private:
  struct Entry {
    Seconds at;
    std::uint64_t number;
    Event event;
    bool operator<(const Entry& other) const {
      return std::pair(at, number) > std::pair(other.at, other.number);
    }
  };
  std::priority_queue<Entry> entries_;
  std::uint64_t next_ = 0;
};

/// The share of the workers' time that the units took, copies of which count once.
double efficiency_of(std::uint32_t units_each, Seconds unit_time, Seconds end) {
  return units_each * unit_time / end;
}

class Durations {
 public:
  explicit Durations(Seconds mean) : range_((1 - kSpread) * mean, (1 + kSpread) * mean) {}
  Seconds next() { return range_(random_); }

 private:
  std::mt19937 random_{1};
  std::uniform_real_distribution<double> range_;
};

/// All workers at one scheduler.
double run_flat(int workers, Seconds unit_time, Seconds service, std::uint32_t units_each) {
  struct Event {
    WorkerId worker;
    UnitId unit;
    bool is_at_scheduler;  // else the worker has finished it
  };
  Plan plan(LeaseRule{.initial = 1e9, .minimum = 1e9, .silence = 1e9, .patience = 1e9});
  SerialServer scheduler(service);
  Timeline<Event> timeline;
  Durations durations(unit_time);
  std::map<WorkerId, std::deque<UnitId>> held;
  Seconds end = 0;
  const auto begin = [&](WorkerId worker, Seconds now) {
    const Seconds takes = durations.next();
    timeline.add(now + takes, {worker, held[worker].front(), false});
  };
  const auto tell = [&](const PlanEvent& first, Seconds now) {
    std::deque<PlanEvent> events{first};
    for (; !events.empty(); events.pop_front())
      for (const PlanOrder& order : plan.handle(events.front(), now)) {
        if (const auto* prepare = std::get_if<Prepare>(&order))
          events.push_back(WorkerPrepared{prepare->worker, prepare->job});
        if (const auto* assign = std::get_if<Assign>(&order)) {
          held[assign->worker].push_back(assign->unit);
          if (held[assign->worker].size() == 1) begin(assign->worker, now);
        }
      }
  };
  for (WorkerId worker = 1; worker <= WorkerId(workers); ++worker) tell(WorkerJoined{worker}, 0);
  tell(JobAdded{.job = 1, .phases = {{.tiles = std::uint32_t(workers), .passes = units_each}}}, 0);
  while (!plan.finished(1) && !timeline.empty()) {
    const auto [now, event] = timeline.next();
    if (event.is_at_scheduler) {
      tell(UnitDone{event.worker, event.unit, 1}, now);
      end = now;
      continue;
    }
    timeline.add(scheduler.done_at(now), {event.worker, event.unit, true});
    std::deque<UnitId>& units = held[event.worker];
    units.pop_front();
    if (!units.empty()) begin(event.worker, now);
  }
  EXPECT_TRUE(plan.finished(1));
  return efficiency_of(units_each, unit_time, end);
}

/// Relays between scheduler and workers. A tile belongs to one relay, which merges its passes in their order
/// and sends the sum: the same bytes as if the scheduler had merged them.
struct Tree {
  int relays = 16, workers_each = 625;
  std::uint32_t passes = 8;  ///< of a tile, all merged by its relay
};

double run_tree(const Tree& tree, Seconds unit_time, Seconds service, std::uint32_t units_each) {
  struct Event {
    enum { kUnitDone, kUnitAtRelay, kTileAtScheduler } what;
    int relay;
    UnitId tile;
    WorkerId slot;
  };
  struct Relay {
    SerialServer server;
    int idle;
    std::deque<std::pair<UnitId, WorkerId>> waiting;  // passes to be given out, by their tile
    std::map<UnitId, std::uint32_t> left;             // of each tile, passes that are not merged
  };
  Plan plan(LeaseRule{.initial = 1e9, .minimum = 1e9, .silence = 1e9, .patience = 1e9});
  SerialServer scheduler(service);
  Timeline<Event> timeline;
  Durations durations(unit_time);
  Seconds end = 0;
  std::vector<Relay> relays(std::size_t(tree.relays), {SerialServer(service), tree.workers_each, {}, {}});
  // A relay stands for as many of the plan's workers as keep two passes at each of its own.
  const int slots = 1 + tree.workers_each / int(tree.passes);
  const auto give_out = [&](int number, Seconds now) {
    Relay& relay = relays[std::size_t(number)];
    for (; relay.idle > 0 && !relay.waiting.empty(); --relay.idle) {
      const auto [tile, slot] = relay.waiting.front();
      relay.waiting.pop_front();
      const Seconds takes = durations.next();
      timeline.add(now + takes, {Event::kUnitDone, number, tile, slot});
    }
  };
  const auto tell = [&](const PlanEvent& first, Seconds now) {
    std::deque<PlanEvent> events{first};
    for (; !events.empty(); events.pop_front())
      for (const PlanOrder& order : plan.handle(events.front(), now)) {
        if (const auto* prepare = std::get_if<Prepare>(&order))
          events.push_back(WorkerPrepared{prepare->worker, prepare->job});
        if (const auto* assign = std::get_if<Assign>(&order)) {
          const int number = int(assign->worker - 1) % tree.relays;
          Relay& relay = relays[std::size_t(number)];
          if (!relay.left.emplace(assign->unit, tree.passes).second) continue;  // a copy within the relay
          for (std::uint32_t pass = 0; pass < tree.passes; ++pass)
            relay.waiting.emplace_back(assign->unit, assign->worker);
          give_out(number, now);
        }
      }
  };
  for (WorkerId slot = 1; slot <= WorkerId(slots * tree.relays); ++slot) tell(WorkerJoined{slot}, 0);
  const std::uint32_t tiles = std::uint32_t(tree.relays * tree.workers_each) * units_each / tree.passes;
  tell(JobAdded{.job = 1, .phases = {{.tiles = tiles, .passes = 1}}}, 0);
  while (!plan.finished(1) && !timeline.empty()) {
    const auto [now, event] = timeline.next();
    Relay& relay = relays[std::size_t(event.relay)];
    switch (event.what) {
      case Event::kUnitDone:
        // As a worker keeps two units, it goes on at once while there is one.
        ++relay.idle;
        give_out(event.relay, now);
        timeline.add(relay.server.done_at(now), {Event::kUnitAtRelay, event.relay, event.tile, event.slot});
        break;
      case Event::kUnitAtRelay:
        if (--relay.left.at(event.tile) > 0) break;
        relay.left.erase(event.tile);
        timeline.add(scheduler.done_at(now), {Event::kTileAtScheduler, event.relay, event.tile, event.slot});
        break;
      case Event::kTileAtScheduler:
        tell(UnitDone{event.slot, event.tile, 1}, now);
        end = now;
        break;
    }
  }
  EXPECT_TRUE(plan.finished(1));
  return efficiency_of(units_each, unit_time, end);
}

// Of two cores, with the workers' own process on them, tests/load/README.md.
constexpr Seconds kService = 50e-6;
constexpr std::uint32_t kUnitsEach = 16;
// At the end workers wait for the last one: for up to the longest unit of those that each has.
constexpr double kTail = (1 + kSpread) / kUnitsEach;

TEST(ScaleSimulation, TenThousandWorkersAreBusyWhereTheirUnitsTakeLongerThanTheSchedulerForAllOfThem) {
  constexpr int kWorkers = 10000;
  for (const Seconds unit_time : {0.25, 0.45, 1.0}) {
    SCOPED_TRACE(unit_time);
    const double expected = std::min(1.0, unit_time / (kWorkers * kService));
    const double efficiency = run_flat(kWorkers, unit_time, kService, kUnitsEach);
    std::cout << "flat, units of " << unit_time << " s: " << efficiency << ", computed " << expected << "\n";
    EXPECT_LE(efficiency, expected * 1.01);
    EXPECT_GE(efficiency, expected * (1 - kTail) - 0.02);
  }
}

TEST(ScaleSimulation, RelaysThatMergeTilesAreWorthAsManyTimesTheWorkersAsTilesHavePasses) {
  const Tree tree;
  const int workers = tree.relays * tree.workers_each;
  for (const Seconds unit_time : {0.04, 0.125, 0.25}) {
    SCOPED_TRACE(unit_time);
    const double root = unit_time * tree.passes / (workers * kService);
    const double relay = unit_time / (tree.workers_each * kService);
    const double expected = std::min({1.0, root, relay});
    const double efficiency = run_tree(tree, unit_time, kService, kUnitsEach);
    std::cout << "tree, units of " << unit_time << " s: " << efficiency << ", computed " << expected << "\n";
    EXPECT_LE(efficiency, expected * 1.01);
    // A relay has whole tiles, so what it ends with is coarser by the passes of one, shared by as many
    // workers.
    EXPECT_GE(efficiency, expected * (1 - 2 * kTail) - 0.02);
  }
}

}  // namespace
}  // namespace penumbra
