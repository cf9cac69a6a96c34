// The plan alone: units per second for a number of workers, each always busy, from the first unit of a job to
// its last. Only events: no results, no network, no threads.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <deque>
#include <utility>
#include <variant>
#include <vector>

#include "scheduler/plan/plan.h"

namespace penumbra {
namespace {

constexpr Seconds kUnitTime = 1, kTickInterval = 0.02;

/// Workers that prepare at once and finish their units in the order in which they got them.
class Workers {
 public:
  void tell(const PlanEvent& event) {
    for (const PlanOrder& order : plan_.handle(event, now_)) {
      if (const auto* prepare = std::get_if<Prepare>(&order))
        prepared_.push_back({prepare->worker, prepare->job});
      if (const auto* assign = std::get_if<Assign>(&order)) held_.push_back({assign->worker, assign->unit});
    }
    while (!prepared_.empty()) {
      const WorkerPrepared next = prepared_.front();
      prepared_.pop_front();
      tell(next);
    }
  }

  /// `workers` of them finish `units` units; true if the plan said so.
  bool run(int workers, std::uint32_t tiles, std::uint32_t passes) {
    for (WorkerId worker = 1; worker <= WorkerId(workers); ++worker) tell(WorkerJoined{worker});
    tell(JobAdded{1, 0, {{.tiles = tiles, .passes = passes}}});
    Seconds next_tick = now_;
    while (!plan_.finished(1)) {
      if (held_.empty()) return false;
      const auto [worker, unit] = held_.front();
      held_.pop_front();
      now_ += kUnitTime / workers;
      tell(UnitDone{worker, unit, 1});
      for (; next_tick <= now_; next_tick += kTickInterval) tell(Tick{});
    }
    tell(JobRemoved{1});
    return true;
  }

 private:
  Plan plan_{LeaseRule{.silence = 1e9}};
  Seconds now_ = 0;
  std::deque<WorkerPrepared> prepared_;
  std::deque<std::pair<WorkerId, UnitId>> held_;
};

void units_of_a_job(benchmark::State& state) {
  const int workers = int(state.range(0));
  const auto tiles = std::uint32_t(state.range(1));
  constexpr std::uint32_t kPasses = 8;
  std::int64_t units = 0;
  for (auto step : state) {
    (void)step;
    if (!Workers().run(workers, tiles, kPasses)) state.SkipWithError("the plan stopped");
    units += std::int64_t(tiles) * kPasses;
  }
  state.SetItemsProcessed(units);
}
BENCHMARK(units_of_a_job)
    ->ArgNames({"workers", "tiles"})
    ->Args({10, 510})
    ->Args({100, 2040})
    ->Args({1000, 8160})
    ->Args({5000, 8160})
    ->Args({10000, 8160})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace penumbra

BENCHMARK_MAIN();
