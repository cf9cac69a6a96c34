// Random schedules of faults against a whole farm of real worker processes and of faulty workers that speak
// the real protocol. Whatever happens, the film must be that of an undisturbed render.
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <iostream>
#include <map>
#include <mutex>
#include <regex>
#include <set>
#include <thread>

#include "tests/scheduler/faults/fault_schedule.h"
#include "tests/support/fake_device.h"
#include "tests/support/fake_processes.h"
#include "tests/support/fake_samples.h"
#include "tests/support/fault_schedules.h"
#include "tests/support/local_render.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using Clock = std::chrono::steady_clock;

constexpr int kSize = 96;
constexpr std::uint32_t kSpp = 18, kSamplesPerPass = 3;
constexpr auto kTimeToEnd = 60s;  // what takes longer hangs

/// x, y and first sample of a unit.
using Place = std::tuple<int, int, std::uint32_t>;

std::uint64_t expected_hash(int tile, const std::set<Place>& missing) {
  FilmAccumulator film(0, 0, kSize, kSize, kNoLayers);
  for (std::uint32_t first = 0; first < kSpp; first += kSamplesPerPass)
    for (int y = 0; y < kSize; y += tile)
      for (int x = 0; x < kSize; x += tile)
        if (!missing.contains({x, y, first}))
          film.add(x, y, fake_samples({x, y, tile, tile, first, kSamplesPerPass}, kNoLayers));
  return film.hash();
}

/// Sends signals to worker processes as the schedule says, and ends what hangs.
class FaultInjector {
 public:
  FaultInjector(const FaultSchedule& schedule, std::atomic<bool>& stop)
      : schedule_(schedule), stop_(stop), thread_([this] { run(); }) {}
  ~FaultInjector() {
    over_ = true;
    thread_.join();
  }
  void begin() { begun_ = true; }
  [[nodiscard]] bool was_too_late() const { return too_late_; }

 private:
  void run() {
    const auto deadline = Clock::now() + kTimeToEnd;
    std::optional<Clock::time_point> start;
    std::deque<ProcessFault> left(schedule_.processes.begin(), schedule_.processes.end());
    std::multimap<Clock::time_point, pid_t> asleep;
    for (; !over_; std::this_thread::sleep_for(2ms)) {
      const auto now = Clock::now();
      if (now > deadline) too_late_ = stop_ = true;
      if (begun_ && !start) start = now;
      for (; start && !left.empty() && now - *start >= left.front().at; left.pop_front()) {
        const ProcessFault& fault = left.front();
        const std::vector<pid_t> workers = children_of(getpid());
        if (workers.empty()) continue;
        const pid_t victim = workers[std::size_t(fault.victim) % workers.size()];
        kill(victim, fault.signal);
        if (fault.wake_up) asleep.emplace(now + *fault.wake_up, victim);
      }
      for (; !asleep.empty() && asleep.begin()->first <= now; asleep.erase(asleep.begin()))
        kill(asleep.begin()->second, SIGCONT);
    }
  }

  const FaultSchedule& schedule_;
  std::atomic<bool>& stop_;
  std::atomic<bool> begun_ = false, over_ = false, too_late_ = false;
  std::thread thread_;
};

class FarmFaults : public testing::Test {
 protected:
  void SetUp() override { setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1); }
  void TearDown() override {
    FakeBehaviour{}.to_environment();
    EXPECT_THAT(children_of(getpid()), IsEmpty()) << "a worker is still there";
  }

  void run(const FaultSchedule& schedule);
  /// The units that problems say are missing.
  static std::set<Place> missing_units(const RenderOutcome& outcome) {
    std::set<Place> missing;
    const std::regex unit(R"(at \((\d+), (\d+)\), samples (\d+) to \d+ are missing in the image)");
    for (const std::string& text : outcome.problems)
      if (std::smatch match; std::regex_search(text, match, unit))
        missing.insert({std::stoi(match[1]), std::stoi(match[2]), std::uint32_t(std::stoul(match[3]))});
    return missing;
  }

  TemporaryFolder folder_;
  std::map<int, std::uint64_t> undisturbed_;  // by tile
  int rogues_active = 0, set_aside = 0, requeued = 0, disputes = 0, verified = 0;
};

void FarmFaults::run(const FaultSchedule& schedule) {
  FakeBehaviour behaviour{.delay_ms = schedule.delay_ms};
  const int tile = schedule.tile, across = kSize / tile;
  if (schedule.crash_tile)
    behaviour.crash_at = std::to_string(*schedule.crash_tile % across * tile) + "," +
                         std::to_string(*schedule.crash_tile / across % across * tile) + "," +
                         std::to_string(kSamplesPerPass);
  behaviour.to_environment();
  LocalRender job;
  job.scene = fake_scene(kSize, kSize, false);
  job.width = job.height = kSize;
  job.spp = kSpp;
  job.request.plan.samples_per_pass = kSamplesPerPass;
  job.request.plan.tile = tile;
  job.request.verify = schedule.verify;
  job.workers = schedule.workers;
  job.worker_executable = PENUMBRA_BINARY_DIR "/fake_worker";
  job.listen = "unix:" + (folder_ / ("s" + std::to_string(schedule.seed))).string();
  job.leases = {.initial = 5, .minimum = 2, .factor = 20, .growth = 2, .silence = 2.5, .patience = 1};

  std::atomic<bool> stop = false;
  std::deque<RogueWorker> rogues;
  for (const RogueHabit& habit : schedule.rogues) rogues.emplace_back(job.listen, habit, kNoLayers);
  FaultInjector injector(schedule, stop);
  const Expected<RenderOutcome> outcome = run_render(job, stop, [&](const RenderProgress& progress) {
    if (progress.samples_done > 0) injector.begin();
  });
  ASSERT_FALSE(injector.was_too_late()) << "it hangs";
  ASSERT_TRUE(outcome) << outcome.error().message;

  const std::set<Place> missing = missing_units(*outcome);
  const auto units = std::uint64_t(across * across) * (kSpp / kSamplesPerPass);
  ASSERT_EQ(outcome->units_set_aside, missing.size());
  ASSERT_EQ(outcome->units_done + outcome->units_set_aside, units) << "a unit is lost";
  ASSERT_EQ(outcome->complete, missing.empty());
  std::uint64_t merged = 0;
  for (const WorkerShare& share : outcome->workers) merged += share.units;
  const auto disputed = std::ranges::count_if(
      outcome->problems, [](const std::string& text) { return text.find("different results") != text.npos; });
  // What is done again is merged again, and only then.
  if (disputed == 0) {
    ASSERT_EQ(merged, outcome->units_done) << "a unit was merged twice";
  }
  // Three faults of one unit: the deadly one, or more bad luck than there are faults in the schedule.
  const std::size_t faults = schedule.processes.size() + schedule.rogues.size();
  ASSERT_LE(missing.size(), (schedule.crash_tile ? 1u : 0u) + faults / kFaultsToSetAside)
      << testing::PrintToString(outcome->problems);
  if (missing.empty()) {
    if (!undisturbed_.contains(tile)) undisturbed_[tile] = expected_hash(tile, {});
    ASSERT_EQ(outcome->film.hash(), undisturbed_[tile]) << testing::PrintToString(outcome->problems);
  } else {
    ASSERT_EQ(outcome->film.hash(), expected_hash(tile, missing))
        << testing::PrintToString(outcome->problems);
  }
  for (const RogueWorker& rogue : rogues) rogues_active += rogue.has_done_it() ? 1 : 0;
  set_aside += int(missing.size());
  requeued += int(outcome->units_requeued);
  disputes += int(disputed) / 2;
  verified += int(outcome->units_verified);
}

TEST_F(FarmFaults, RandomSchedulesGiveTheUndisturbedFilm) {
  const std::vector<unsigned> seeds = fault_seeds(20);
  for (const unsigned seed : seeds) {
    const FaultSchedule schedule = FaultSchedule::of(seed);
    SCOPED_TRACE(schedule.text());
    run(schedule);
    if (HasFatalFailure()) return;
  }
  if (seeds.size() < 20) return;
  // The schedules must contain what they are there for.
  EXPECT_GT(rogues_active, 10);
  EXPECT_GT(requeued, 20);
  EXPECT_GT(verified, 50);
  std::cout << seeds.size() << " schedules: " << requeued << " units requeued, " << rogues_active
            << " rogues did what they are there for, " << disputes << " disputes, " << verified
            << " units verified, " << set_aside << " set aside\n";
}

class OneRogue : public FarmFaults, public testing::WithParamInterface<int> {};

TEST_P(OneRogue, ChangesNothing) {
  const auto roguery = Roguery(GetParam());
  FaultSchedule schedule;
  schedule.rogues.push_back({.roguery = roguery, .at = 3});
  if (roguery == Roguery::kLies) schedule.verify = 1;
  SCOPED_TRACE(schedule.text());
  run(schedule);
  EXPECT_EQ(set_aside, 0);
  EXPECT_EQ(rogues_active, 1);
  if (roguery == Roguery::kLies) {
    EXPECT_GE(disputes, 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Rogueries, OneRogue, testing::Range(int(Roguery::kSlow), int(Roguery::kCount)),
                         [](const auto& parameter) {
                           std::string name = text_of(Roguery(parameter.param));
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

}  // namespace
}  // namespace penumbra
