// The plan against thousands of random schedules. Jobs have several phases and priorities, and another
// scheduler has begun some of them. Workers die, hang, come back late, fail, or send damaged results; some
// units make every worker do so. Whatever happens, each film must be that of an undisturbed render.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <ostream>
#include <random>
#include <set>
#include <vector>

#include "scheduler/plan/merge.h"
#include "scheduler/plan/plan.h"
#include "tests/support/fault_schedules.h"
#include "tests/support/film_layers.h"

namespace penumbra {
namespace {

constexpr Seconds kNever = std::numeric_limits<Seconds>::infinity();
constexpr int kMostEvents = 20000;

struct Habits {
  double dies = 0, hangs = 0, late = 0, fails = 0, corrupts = 0;  // probability for each unit
  double poisonous = 0;                                           // share of units that never succeed
  double lies = 0;                                                // probability that a worker is a liar
  double verified = 0;                                            // share of units done by two workers
  double cancelled = 0;  // probability in half a second that a job is removed
};

/// One run with one seed.
class SimulatedFarm {
 public:
  SimulatedFarm(unsigned seed, const Habits& habits) : random_(seed), habits_(habits) {
    for (JobId job = JobId(between(1, 3)); job > 0; --job) {
      for (int phases = between(1, 2); phases > 0; --phases)
        jobs_[job].push_back({.tiles = std::uint32_t(between(1, 12)),
                              .passes = std::uint32_t(between(1, 5)),
                              .passes_at_once = std::uint32_t(std::max(1, between(-3, 4)))});
      make_merges(job);
    }
    for (auto& [job, phases] : jobs_)
      if (chance(0.4)) begin_before(job, phases);
    for_each_unit([&](const UnitId& unit) {
      if (chance(habits_.poisonous) && !merged_.contains(unit)) poison_.emplace(unit, between(0, 2));
    });
  }

  void run() {
    plan_.emplace(LeaseRule{.initial = 20, .minimum = 5, .factor = 3, .growth = 2, .silence = 8});
    for (const auto& [job, phases] : jobs_)
      tell(JobAdded{.job = job, .priority = between(0, 2), .phases = phases, .verify = habits_.verified});
    for (int crew = between(1, 6); crew > 0; --crew) join();
    for (int events = 0; !plan_->finished() && !plan_->gave_up(); ++events) {
      ASSERT_LT(events, kMostEvents) << "the plan does not come to an end";
      step();
      if (testing::Test::HasFatalFailure()) return;
    }
    if (plan_->finished()) check_the_end();
  }

  [[nodiscard]] bool gave_up() const { return plan_->gave_up(); }
  int dismissals = 0, set_asides = 0, duplicates = 0, restarts = 0, resumed = 0, redone_from_before = 0;
  int verified = 0, not_verified = 0, cancelled = 0, died_of_removed_jobs = 0;

 private:
  enum class Fate { kDone, kDies, kFails, kCorrupt };
  struct FakeWorker {
    std::vector<UnitId> units;
    std::set<JobId> prepared;
    std::deque<JobId> preparing;  // begun when its units are done; also those that it was told to forget
    Seconds prepared_at = kNever;
    Seconds ready_at = kNever;
    Fate fate = Fate::kDone;
    double speed = 1;
    bool liar = false;
  };

  int between(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }
  bool chance(double probability) { return std::bernoulli_distribution(probability)(random_); }

  template <typename Do>
  void for_each_unit(const Do& act) const {
    for (const auto& [job, phases] : jobs_)
      for (std::uint32_t phase = 0; phase < phases.size(); ++phase)
        for (std::uint32_t pass = 0; pass < phases[phase].passes; ++pass)
          for (std::uint32_t tile = 0; tile < phases[phase].tiles; ++tile)
            act(UnitId{job, phase, pass, tile});
  }

  /// What an earlier scheduler has merged of the job: in its first phase, or also in its second one.
  void begin_before(JobId job, std::vector<PhaseUnits>& phases) {
    ++resumed;
    const std::uint32_t last = std::uint32_t(between(0, int(phases.size()) - 1));
    for (std::uint32_t phase = 0; phase <= last; ++phase) {
      PhaseUnits& units = phases[phase];
      for (std::uint32_t tile = 0; tile < units.tiles; ++tile) {
        const auto merged = std::uint32_t(phase < last ? int(units.passes) : between(0, int(units.passes)));
        units.merged.push_back(merged);
        for (std::uint32_t pass = 0; pass < merged; ++pass) {
          const UnitId unit{job, phase, pass, tile};
          merged_.emplace(unit, 0);
          merge_of(unit).add(tile, pass, result(unit, false));
        }
      }
    }
  }

  void make_merges(JobId job) {
    merges_[job].clear();
    for (const PhaseUnits& phase : jobs_[job])
      merges_[job].emplace_back(FilmAccumulator(0, 0, int(phase.tiles), 1, kNoLayers),
                                TileGrid(0, 0, int(phase.tiles), 1, 1, phase.passes, 1));
  }
  Merge& merge_of(const UnitId& unit) { return merges_.at(unit.job).at(unit.phase); }

  void step() {
    const auto preparing =
        std::ranges::min_element(workers_, {}, [](const auto& w) { return w.second.prepared_at; });
    if (preparing != workers_.end() && preparing->second.prepared_at <= now_) {
      FakeWorker& worker = preparing->second;
      const WorkerId id = preparing->first;
      worker.prepared_at = kNever;
      const JobId job = worker.preparing.front();
      worker.preparing.pop_front();
      // One more, and the job would count as deadly; not one that is gone already.
      const bool is_removed = !jobs_.contains(job);
      if (chance(habits_.dies) && (is_removed || deaths_of_preparing_[job] + 1 < kDeathsToGiveUpJob)) {
        ++(is_removed ? died_of_removed_jobs : deaths_of_preparing_[job]);
        workers_.erase(preparing);
        tell(WorkerLost{id});
        return;
      }
      if (!is_removed) {
        worker.prepared.insert(job);
        deaths_of_preparing_[job] = 0;
      }
      begin(worker);
      tell(WorkerPrepared{id, job});
      return;
    }
    auto next = std::ranges::min_element(workers_, {}, [](const auto& w) { return w.second.ready_at; });
    const bool worker_is_next = next != workers_.end() && next->second.ready_at <= next_tick_;
    now_ = worker_is_next ? std::max(now_, next->second.ready_at) : next_tick_;
    if (!worker_is_next) {
      next_tick_ += 0.5;
      beat();
      if (int(workers_.size()) < 2 || chance(0.02)) join();  // the dead are replaced, some others come too
      if (chance(habits_.cancelled)) cancel();
      tell(Tick{});
      return;
    }
    const WorkerId id = next->first;
    FakeWorker& worker = next->second;
    const UnitId unit = worker.units.front();
    switch (worker.fate) {
      case Fate::kDies:
        workers_.erase(next);
        ++faults_[unit];
        tell(WorkerLost{id});
        return;
      case Fate::kFails:
        finish_front(worker);
        ++faults_[unit];
        tell(UnitFailed{id, unit});
        return;
      case Fate::kCorrupt:
        finish_front(worker);
        ++faults_[unit];
        tell(ResultCorrupt{id, unit});
        return;
      case Fate::kDone: {
        const bool lie = worker.liar && chance(0.5);
        finish_front(worker);
        tell(UnitDone{id, unit, lie ? id + 1000 : 7}, lie);
        return;
      }
    }
  }

  /// Workers say that they are alive, and now and then that they get on; not those that hang, and half of the
  /// others' words are lost.
  void beat() {
    std::vector<WorkerId> alive;
    for (const auto& [id, worker] : workers_)
      if (!worker.units.empty() && worker.ready_at != kNever && chance(0.5)) alive.push_back(id);
    for (const WorkerId id : alive) {
      tell(Alive{id});
      if (chance(0.3)) tell(Progressed{id});
    }
  }

  /// Somebody does not want the oldest job any more, while another one is open.
  void cancel() {
    if (jobs_.size() < 2) return;
    ++cancelled;
    const JobId job = jobs_.begin()->first;
    jobs_.erase(job);
    merges_.erase(job);
    forget(job);
    tell(JobRemoved{job});
  }

  void forget(JobId job) {
    const auto is_of_job = [job](const UnitId& unit) { return unit.job == job; };
    std::erase_if(merged_, [&](const auto& m) { return is_of_job(m.first); });
    std::erase_if(set_aside_, is_of_job);
    std::erase_if(lies_, is_of_job);
    std::erase_if(poison_, [&](const auto& p) { return is_of_job(p.first) && !jobs_.contains(job); });
    std::erase_if(opened_, [&](const auto& phase) { return phase.first == job; });
    std::erase_if(phases_done_, [&](const PhaseDone& done) { return done.job == job; });
    for (auto& [id, worker] : workers_)
      if (std::erase_if(worker.units, is_of_job) > 0) begin(worker);
  }

  void join() {
    if (workers_.size() >= 8) return;
    const WorkerId id = next_worker_++;
    FakeWorker& worker = workers_[id];
    worker.speed = 0.2 + 0.3 * between(1, 10);
    worker.liar = chance(habits_.lies);
    tell(WorkerJoined{id});
  }

  void finish_front(FakeWorker& worker) {
    worker.units.erase(worker.units.begin());
    begin(worker);
  }

  void begin(FakeWorker& worker) {
    worker.ready_at = kNever;
    worker.fate = Fate::kDone;
    if (worker.units.empty()) {
      if (!worker.preparing.empty() && worker.prepared_at == kNever)
        worker.prepared_at = now_ + 0.1 * between(0, 30);
      return;
    }
    worker.ready_at = now_ + worker.speed * 0.1 * between(8, 12);
    const auto poison = poison_.find(worker.units.front());
    if (poison != poison_.end()) {
      if (poison->second == 2) worker.ready_at = kNever;
      worker.fate = poison->second == 0 ? Fate::kDies : Fate::kFails;
    } else if (chance(habits_.dies)) {
      worker.fate = Fate::kDies;
    } else if (chance(habits_.fails)) {
      worker.fate = Fate::kFails;
    } else if (chance(habits_.corrupts)) {
      worker.fate = Fate::kCorrupt;
    } else if (chance(habits_.hangs)) {
      worker.ready_at = kNever;
    } else if (chance(habits_.late)) {
      worker.ready_at = now_ + between(1, 150);
    }
  }

  void tell(const PlanEvent& event, bool lie = false) {
    for (const PlanOrder& order : plan_->handle(event, now_)) {
      std::visit([&](const auto& o) { obey(o, lie); }, order);
    }
    for (const PhaseDone& done : std::exchange(phases_done_, {})) tell(PhaseOpened{done.job, done.phase + 1});
  }

  void obey(const Prepare& order, bool) {
    FakeWorker& worker = workers_.at(order.worker);
    for (const JobId job : worker.preparing) ASSERT_FALSE(jobs_.contains(job)) << "two jobs at once";
    ASSERT_FALSE(worker.prepared.contains(order.job)) << "the worker knows the job";
    ASSERT_LT(worker.prepared.size(), std::size_t(kJobsPerWorker));
    worker.preparing.push_back(order.job);
    if (worker.units.empty()) begin(worker);
  }

  void obey(const Forget& order, bool) {
    FakeWorker& worker = workers_.at(order.worker);
    if (std::ranges::find(worker.preparing, order.job) == worker.preparing.end()) {
      ASSERT_EQ(worker.prepared.erase(order.job), 1u);
    }
  }

  void obey(const PhaseDone& order, bool) {
    ASSERT_EQ(merges_.at(order.job).at(order.phase).finished_passes(), jobs_[order.job][order.phase].passes);
    ASSERT_LT(order.phase + 1, jobs_[order.job].size());
    phases_done_.push_back(order);
    opened_.insert({order.job, order.phase + 1});
  }

  void obey(const RestartJob& order, bool) {
    ++restarts;
    ASSERT_GT(habits_.lies, 0);
    make_merges(order.job);
    forget(order.job);
  }

  /// Whoever starts workers may give such a job up; here there are always others.
  void obey(const NoCapableWorker& order, bool) {
    ASSERT_TRUE(order.at_units) << "every worker can";
    ASSERT_GE(order.deaths, deaths_at_units_to_give_up_job(1));
  }

  void obey(const Assign& order, bool) {
    const auto found = workers_.find(order.worker);
    ASSERT_NE(found, workers_.end()) << "a unit for a worker that is gone";
    FakeWorker& worker = found->second;
    const UnitId& unit = order.unit;
    ASSERT_TRUE(worker.prepared.contains(unit.job)) << "a unit of a job that the worker does not know";
    ASSERT_TRUE(unit.phase == 0 || opened_.contains({unit.job, unit.phase})) << "before the barrier";
    ASSERT_LT(unit.tile, jobs_.at(unit.job).at(unit.phase).tiles);
    ASSERT_LT(unit.pass, jobs_.at(unit.job).at(unit.phase).passes);
    ASSERT_EQ(std::ranges::count(worker.units, order.unit), 0) << "a worker has the unit already";
    const auto before = merged_.find(unit);
    ASSERT_TRUE(before == merged_.end() || before->second != 0) << "an earlier scheduler has merged it";
    ASSERT_TRUE(before == merged_.end() || before->second != order.worker) << "its own result for comparison";
    worker.units.push_back(order.unit);
    ASSERT_LE(worker.units.size(), std::size_t(kUnitsPerWorker));
    if (worker.units.size() == 1) begin(worker);
  }

  void obey(const MergeResult& order, bool lie) {
    ASSERT_TRUE(merged_.emplace(order.unit, order.worker).second) << "merged twice";
    ASSERT_FALSE(set_aside_.contains(order.unit));
    if (lie) lies_.insert(order.unit);
    merge_of(order.unit).add(order.unit.tile, order.unit.pass, result(order.unit, lie));
  }

  void obey(const DiscardResult&, bool) { ++duplicates; }

  void obey(const SetAside& order, bool) {
    ++set_asides;
    ASSERT_TRUE(set_aside_.insert(order.unit).second) << "set aside twice";
    ASSERT_FALSE(merged_.contains(order.unit));
    ASSERT_GE(order.faults.size(), std::size_t(kFaultsToSetAside));
    // Expired leases are faults too, but only of units that hang or are late.
    if (habits_.hangs + habits_.late + habits_.poisonous == 0) {
      ASSERT_GE(faults_[order.unit], kFaultsToSetAside);
    }
    merge_of(order.unit).skip(order.unit.tile, order.unit.pass);
  }

  void obey(const DismissWorker& order, bool) {
    ++dismissals;
    ASSERT_TRUE(workers_.contains(order.worker));
    workers_.erase(order.worker);
    if (order.fault == Fault::kDisputed) disputed_.insert({order.worker, *order.accuser});
  }

  void obey(const RedoTile& order, bool) {
    merges_.at(order.job).at(order.phase).redo(order.tile);
    const auto in_tile = [&](const UnitId& unit) {
      return unit.job == order.job && unit.phase == order.phase && unit.tile == order.tile;
    };
    redone_from_before +=
        int(std::erase_if(merged_, [&](const auto& m) { return in_tile(m.first) && m.second == 0; }));
    std::erase_if(merged_, [&](const auto& m) { return in_tile(m.first); });
    std::erase_if(lies_, in_tile);
  }

  void obey(const UnitOverdue& order, bool) { ASSERT_TRUE(workers_.contains(order.worker)); }

  void obey(const GiveUp&, bool) { ASSERT_GT(habits_.lies, 0); }

  static SampleBuffer result(const UnitId& unit, bool lie) {
    // Values that round differently in every order of merging.
    const float value =
        1.0f / float(3 + unit.pass * 7 + unit.tile + unit.job + 5 * unit.phase) + (lie ? 1.0f : 0.0f);
    return {.width = 1,
            .height = 1,
            .planes = kNoLayers.planes(),
            .sample_count = 1,
            .values = {value, value * 3, value * 5, 0, 0, 0}};
  }

  void check_the_end() {
    std::size_t total = 0, done = 0;
    for (const auto& [job, phases] : jobs_) {
      for (std::uint32_t phase = 0; phase < phases.size(); ++phase) {
        const Merge& merge = merges_.at(job).at(phase);
        total += std::size_t(phases[phase].tiles) * phases[phase].passes;
        ASSERT_EQ(merge.finished_passes(), phases[phase].passes);
        ASSERT_EQ(merge.waiting(), 0u);
        if (lies_.empty()) {
          ASSERT_EQ(merge.film().hash(), undisturbed(job, phase));
        }
      }
      ASSERT_TRUE(plan_->finished(job));
      const Plan::Counts counts = plan_->counts(job);
      done += counts.done;
      verified += int(counts.verified);
      not_verified += int(counts.not_verified);
      // Each has been compared with another worker's.
      if (habits_.verified == 1 && counts.not_verified == 0) {
        ASSERT_TRUE(
            std::ranges::none_of(lies_, [&, of = job](const UnitId& unit) { return unit.job == of; }));
      }
      for (const UnitId& unit : plan_->set_aside(job)) ASSERT_TRUE(set_aside_.contains(unit));
    }
    ASSERT_EQ(merged_.size() + set_aside_.size(), total) << "a unit is lost";
    ASSERT_EQ(done, merged_.size());
    for (const auto& [unit, kind] : poison_) ASSERT_TRUE(set_aside_.contains(unit));
    for (const auto& [a, b] : disputed_) {
      for (const auto& [unit, worker] : merged_)
        ASSERT_TRUE(worker != a && worker != b) << "untrustworthy work";
    }
  }

  std::uint64_t undisturbed(JobId job, std::uint32_t phase) {
    const PhaseUnits& units = jobs_.at(job).at(phase);
    FilmAccumulator film(0, 0, int(units.tiles), 1, kNoLayers);
    for (std::uint32_t pass = 0; pass < units.passes; ++pass) {
      for (std::uint32_t tile = 0; tile < units.tiles; ++tile) {
        const UnitId unit{job, phase, pass, tile};
        if (!set_aside_.contains(unit)) film.add(int(tile), 0, result(unit, false));
      }
    }
    return film.hash();
  }

  std::mt19937 random_;
  const Habits habits_;
  std::map<JobId, std::vector<PhaseUnits>> jobs_;
  std::map<JobId, std::vector<Merge>> merges_;
  std::vector<PhaseDone> phases_done_;
  std::set<std::pair<JobId, std::uint32_t>> opened_;
  std::map<JobId, int> deaths_of_preparing_;  // since the last that was ready
  std::map<UnitId, int> poison_;              // what it does: kills, fails, hangs
  std::optional<Plan> plan_;
  std::map<WorkerId, FakeWorker> workers_;
  WorkerId next_worker_ = 1;
  Seconds now_ = 0, next_tick_ = 0.5;
  std::map<UnitId, WorkerId> merged_;
  std::map<UnitId, int> faults_;
  std::set<UnitId> set_aside_, lies_;
  std::set<std::pair<WorkerId, WorkerId>> disputed_;
};

struct Scenario {
  const char* name;
  Habits habits;
};

void PrintTo(const Scenario& scenario, std::ostream* out) { *out << scenario.name; }

class PlanSimulation : public testing::TestWithParam<Scenario> {};

TEST_P(PlanSimulation, NothingIsLostNothingIsMergedTwiceAndItEnds) {
  const std::vector<unsigned> seeds = fault_seeds(1500);
  int verified = 0, not_verified = 0, cancelled = 0, died_of_removed_jobs = 0;
  int dismissals = 0, set_asides = 0, duplicates = 0, restarts = 0, given_up = 0, resumed = 0, redone = 0;
  for (const unsigned seed : seeds) {
    SCOPED_TRACE(testing::Message() << GetParam().name << ", PENUMBRA_FAULT_SEED=" << seed);
    SimulatedFarm farm(seed, GetParam().habits);
    farm.run();
    if (HasFatalFailure()) return;
    dismissals += farm.dismissals;
    set_asides += farm.set_asides;
    duplicates += farm.duplicates;
    restarts += farm.restarts;
    given_up += farm.gave_up() ? 1 : 0;
    resumed += farm.resumed;
    redone += farm.redone_from_before;
    verified += farm.verified;
    not_verified += farm.not_verified;
    cancelled += farm.cancelled;
    died_of_removed_jobs += farm.died_of_removed_jobs;
  }
  if (seeds.size() < 1000) return;
  // The scenarios must contain what they are there for.
  const Habits& habits = GetParam().habits;
  EXPECT_GT(duplicates, 0);
  EXPECT_GT(resumed, 500);
  if (habits.lies > 0) EXPECT_GT(redone, 20) << "units of an earlier scheduler";
  if (habits.poisonous > 0) EXPECT_GT(set_asides, 100);
  if (habits.corrupts + habits.hangs + habits.lies > 0) EXPECT_GT(dismissals, 100);
  if (habits.verified == 1 && habits.dies == 0) EXPECT_GT(verified, 100 * not_verified);
  if (habits.verified > 0) EXPECT_GT(verified, 1000);
  if (habits.cancelled > 0) EXPECT_GT(cancelled, 500);
  if (habits.cancelled > 0 && habits.dies > 0) EXPECT_GT(died_of_removed_jobs, 5);
  if (habits.lies == 0) EXPECT_EQ(given_up, 0);
  if (habits.lies > 0) EXPECT_GT(restarts, 20);
}

INSTANTIATE_TEST_SUITE_P(Habits, PlanSimulation,
                         testing::Values(Scenario{"healthy", {}}, Scenario{"mortal", {.dies = 0.15}},
                                         Scenario{"sleepy", {.hangs = 0.05, .late = 0.1}},
                                         Scenario{"clumsy", {.fails = 0.1, .corrupts = 0.05}},
                                         Scenario{"poisoned", {.dies = 0.02, .poisonous = 0.1}},
                                         Scenario{"lying", {.dies = 0.05, .late = 0.05, .lies = 0.2}},
                                         Scenario{"cancelled", {.dies = 0.3, .cancelled = 0.2}},
                                         Scenario{"verified", {.hangs = 0.02, .verified = 1}},
                                         Scenario{"lying_and_verified", {.lies = 0.1, .verified = 1}},
                                         Scenario{"everything",
                                                  {.dies = 0.05,
                                                   .hangs = 0.03,
                                                   .late = 0.05,
                                                   .fails = 0.05,
                                                   .corrupts = 0.03,
                                                   .poisonous = 0.05,
                                                   .lies = 0.05,
                                                   .verified = 0.1,
                                                   .cancelled = 0.02}}),
                         [](const auto& parameter) { return parameter.param.name; });

}  // namespace
}  // namespace penumbra
