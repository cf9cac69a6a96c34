// Passes that are issued side by side, because their units share something that each worker makes itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <iostream>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "tests/scheduler/plan/plan_fixture.h"

namespace penumbra {
namespace {

using testing::UnorderedElementsAre;

class PlanPasses : public PlanTest {
 protected:
  void start_side_by_side(std::uint32_t tiles, std::uint32_t passes, std::uint32_t at_once) {
    plan_.emplace(LeaseRule{.silence = kNever});
    add(kJob, {{.tiles = tiles, .passes = passes, .passes_at_once = at_once}});
  }
  /// Both units of a worker.
  std::vector<UnitId> held(WorkerId worker) { return held_[worker]; }
};

TEST_F(PlanPasses, EachWorkerHasAPassOfItsOwn) {
  start_side_by_side(4, 8, 8);
  for (const WorkerId worker : {1, 2}) join(worker);
  EXPECT_EQ(held(1), (std::vector{unit(0, 0), unit(0, 1)}));
  EXPECT_EQ(held(2), (std::vector{unit(1, 0), unit(1, 1)}));
  work(2);
  work(2);
  EXPECT_EQ(held(2), (std::vector{unit(1, 2), unit(1, 3)}));
  work(2);
  EXPECT_EQ(held(2), (std::vector{unit(1, 3), unit(2, 0)})) << "nobody is at the third pass";
}

TEST_F(PlanPasses, WithoutSharingUnitsAreIssuedPassByPass) {
  start_side_by_side(4, 8, 1);
  for (const WorkerId worker : {1, 2}) join(worker);
  EXPECT_EQ(held(2), (std::vector{unit(0, 2), unit(0, 3)}));
  work(1);
  EXPECT_EQ(held(1), (std::vector{unit(0, 1), unit(1, 0)}));
}

TEST_F(PlanPasses, AWorkerHelpsWhereTheFewestAreWhenNoFurtherPassMayBegin) {
  start_side_by_side(6, 8, 2);
  for (const WorkerId worker : {1, 2, 3}) join(worker);
  EXPECT_EQ(held(3), (std::vector{unit(0, 2), unit(0, 3)})) << "passes 0 and 1 have a worker each";
  join(4);
  EXPECT_EQ(held(4), (std::vector{unit(1, 2), unit(1, 3)}));
}

TEST_F(PlanPasses, AWorkerThatIsGoneIsAtNoPass) {
  start_side_by_side(6, 8, 8);
  join(1);
  join(2);
  held_.erase(1);
  tell(WorkerLost{1, true});
  work(2);
  work(2);  // the units of the other one
  EXPECT_EQ(held(2), (std::vector{unit(0, 0), unit(0, 1)}));
  join(3);
  EXPECT_EQ(held(3), (std::vector{unit(1, 2), unit(1, 3)}));
}

TEST_F(PlanPasses, PassesBeginOnlyNearTheFirstThatHasUnitsToIssue) {
  start_side_by_side(5, 20, 3);
  join(1);  // has two units of pass 0 and never finishes them
  join(2);
  std::vector<std::uint32_t> passes;
  for (int i = 0; i < 14; ++i) {
    passes.push_back(held(2).front().pass);
    work(2);
  }
  EXPECT_THAT(passes, testing::ElementsAre(1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 0, 0, 0, 3))
      << "it helps, and units that others hold do not hold it up";
}

TEST_F(PlanPasses, PassesThatWereBegunAreCompletedWhenTimeIsUp) {
  start_side_by_side(3, 8, 8);
  join(1);
  join(2);
  tell(NoFurtherUnits{kJob});
  std::set<UnitId> done;
  while (!plan_->finished()) {
    for (const WorkerId worker : {1, 2}) {
      if (held(worker).empty()) continue;
      const UnitId next = held(worker).front();
      if (!done.insert(next).second) continue;
      work(worker);
    }
  }
  EXPECT_THAT(done, UnorderedElementsAre(unit(0, 0), unit(0, 1), unit(0, 2), unit(1, 0), unit(1, 1)));
}

TEST_F(PlanPasses, ATileIsRedoneWithThePassesThatRanAhead) {
  plan_.emplace(LeaseRule{.silence = kNever});
  tell(JobAdded{.job = kJob, .phases = {{.tiles = 2, .passes = 4, .passes_at_once = 4}}, .verify = 1});
  join(1);
  join(2);
  EXPECT_EQ(held(2), (std::vector{unit(1, 0), unit(1, 1)}));
  work(2);  // pass 1 of tile 0, before pass 0 of it
  join(3);
  EXPECT_EQ(held(3).front(), unit(1, 0)) << "to be verified";
  done(3, unit(1, 0), 8);  // the results differ
  EXPECT_THAT(tiles_to_redo(), testing::ElementsAre(0u));
  EXPECT_THAT(held(1), testing::ElementsAre(unit(0, 0), unit(0, 1)));
  std::set<UnitId> merged_units;
  while (!plan_->finished()) {
    join(4);
    for (const WorkerId worker : {1, 4}) {
      if (held(worker).empty()) continue;
      work(worker);
      for (const UnitId& id : merged()) EXPECT_TRUE(merged_units.insert(id).second) << "merged twice";
    }
  }
  EXPECT_EQ(merged_units.size(), 8u);
}

/// What workers made to render an image.
struct Effort {
  std::size_t maps = 0;     ///< runs of units of one pass at one worker
  std::size_t waiting = 0;  ///< the most results that waited for an earlier pass of their tile
  Seconds seconds = 0;
};

/// Renders an image with workers of different speeds. `dies`: the probability for each unit that its worker
/// does, and that another one comes.
Effort render(int workers, std::uint32_t tiles, std::uint32_t passes, std::uint32_t at_once,
              double dies = 0) {
  struct Busy {
    Seconds until = 0;
    double speed = 1;
    std::deque<UnitId> units = {};
    std::optional<std::uint32_t> map = {};
  };
  Plan plan(LeaseRule{.initial = 1e9, .minimum = 1e9, .silence = 1e9, .patience = 1e9});
  std::mt19937 random{1};
  std::uniform_real_distribution<double> share(0, 1);
  std::map<WorkerId, Busy> crew;
  std::set<std::pair<Seconds, WorkerId>> timeline;
  std::vector<std::set<std::uint32_t>> results(tiles);  // of each tile the passes that wait
  std::vector<std::uint32_t> merged(tiles);
  std::set<UnitId> done;
  std::size_t waiting = 0;
  WorkerId next_worker = 1;
  Effort effort;
  Seconds now = 0;
  const auto begin = [&](WorkerId id) {
    Busy& worker = crew.at(id);
    const std::uint32_t pass = worker.units.front().pass;
    if (worker.map != pass) ++effort.maps;
    worker.map = pass;
    worker.until = now + worker.speed * (0.8 + 0.4 * share(random));
    timeline.emplace(worker.until, id);
  };
  const auto tell = [&](const PlanEvent& first) {
    std::deque<PlanEvent> events{first};
    for (; !events.empty(); events.pop_front())
      for (const PlanOrder& order : plan.handle(events.front(), now)) {
        if (const auto* prepare = std::get_if<Prepare>(&order))
          events.push_back(WorkerPrepared{prepare->worker, prepare->job});
        if (const auto* assign = std::get_if<Assign>(&order)) {
          std::deque<UnitId>& units = crew.at(assign->worker).units;
          units.push_back(assign->unit);
          if (units.size() == 1) begin(assign->worker);
        }
        if (const auto* merge = std::get_if<MergeResult>(&order)) {
          const auto [job, phase, pass, tile] = merge->unit;
          EXPECT_TRUE(done.insert(merge->unit).second) << "twice";
          results[tile].insert(pass);
          for (++waiting; results[tile].erase(merged[tile]) > 0; --waiting) ++merged[tile];
          effort.waiting = std::max(effort.waiting, waiting);
        }
      }
  };
  const auto join = [&] {
    const WorkerId id = next_worker++;
    crew[id].speed = 0.5 + share(random);
    tell(WorkerJoined{id});
  };
  tell(JobAdded{kJob, 0, {{.tiles = tiles, .passes = passes, .passes_at_once = at_once}}});
  for (int i = 0; i < workers; ++i) join();
  while (!plan.finished() && !timeline.empty()) {
    const auto [at, id] = *timeline.begin();
    timeline.erase(timeline.begin());
    now = at;
    Busy& worker = crew.at(id);
    const UnitId unit = worker.units.front();
    if (share(random) < dies) {
      crew.erase(id);
      tell(WorkerLost{id});
      join();
      continue;
    }
    worker.units.pop_front();
    if (!worker.units.empty()) begin(id);
    tell(UnitDone{id, unit, 7});
  }
  EXPECT_EQ(done.size(), std::size_t(tiles) * passes) << "a unit is lost";
  EXPECT_EQ(waiting, 0u);
  effort.seconds = now;
  return effort;
}

TEST(PlanPassesSimulation, WorkersMakeFewerMapsAndAreNotIdle) {
  constexpr std::uint32_t kTiles = 135, kPasses = 64;  // 3840 x 2160 pixels in tiles of 256
  for (const int workers : {1, 2, 4, 1000}) {
    const Effort by_pass = render(workers, kTiles, kPasses, 1);
    std::cout << workers << " workers, pass by pass: " << by_pass.maps << " maps, " << by_pass.waiting
              << " results wait, " << by_pass.seconds << " units' time\n";
    for (const std::uint32_t at_once : {4, 16, 64}) {
      SCOPED_TRACE(testing::Message() << workers << " workers, " << at_once << " passes at once");
      const Effort effort = render(workers, kTiles, kPasses, at_once);
      std::cout << workers << " workers, " << at_once << " passes: " << effort.maps << " maps, "
                << effort.waiting << " results wait, " << effort.seconds << " units' time\n";
      EXPECT_LE(effort.seconds, by_pass.seconds + 1) << "workers are idle";
      if (at_once < 2 * std::uint32_t(workers)) continue;
      // Each pass once. In the end, workers for which there is no pass left help others.
      EXPECT_GE(effort.maps, kPasses);
      EXPECT_LE(effort.maps, kPasses + 2 * std::size_t(workers));
    }
  }
}

TEST(PlanPassesSimulation, SomeSideBySideAreBetterThanNone) {
  const Effort by_pass = render(1000, 135, 64, 1), effort = render(1000, 135, 64, 64);
  EXPECT_LT(effort.maps, by_pass.maps / 3);
  EXPECT_LT(effort.waiting, 2 * by_pass.waiting);
}

TEST(PlanPassesSimulation, AllUnitsAreDoneOnceAlthoughWorkersDie) {
  for (const int workers : {1, 2, 4, 30}) {
    SCOPED_TRACE(workers);
    const Effort by_pass = render(workers, 20, 64, 1, 0.02), effort = render(workers, 20, 64, 16, 0.02);
    if (workers > 1) EXPECT_LT(effort.maps, by_pass.maps);
  }
}

}  // namespace
}  // namespace penumbra
