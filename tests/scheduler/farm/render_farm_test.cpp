// Several jobs on one farm. Worker processes and connections are real; only the device is a fake.
#include "scheduler/farm/render_farm.h"

#include <gmock/gmock.h>
#include <stdlib.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "tests/support/fake_device.h"
#include "tests/support/fake_samples.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::render_farm_test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kSize = 40;
constexpr std::uint32_t kSpp = 6, kSamplesPerPass = 2;

/// Its fake samples lie in [shift, shift + 1).
std::shared_ptr<RenderJob> job(float shift) {
  auto made = std::make_shared<RenderJob>();
  made->scene = fake_scene(kSize, kSize, false);
  made->scene.header.camera.origin.x = shift;
  made->width = made->height = kSize;
  made->spp = kSpp;
  made->request.plan.samples_per_pass = kSamplesPerPass;
  made->request.plan.tile = 16;
  return made;
}

std::uint64_t expected_hash(float shift) {
  FilmAccumulator film(0, 0, kSize, kSize, kNoLayers);
  for (std::uint32_t first = 0; first < kSpp; first += kSamplesPerPass)
    film.add(0, 0, fake_samples({0, 0, kSize, kSize, first, kSamplesPerPass}, kNoLayers, shift));
  return film.hash();
}

/// Jobs in a list, of which one comes whenever `gap` has passed.
class ListedJobs final : public JobSource {
 public:
  std::vector<std::shared_ptr<const RenderJob>> jobs;
  std::chrono::milliseconds gap{0};
  std::vector<JobId> finished;  // in their order
  std::map<JobId, Expected<RenderOutcome>> outcomes;
  std::size_t most_open = 0;

  std::shared_ptr<const RenderJob> next() override {
    const auto now = std::chrono::steady_clock::now();
    if (taken_ == jobs.size() || now < next_at_) return nullptr;
    next_at_ = now + gap;
    return jobs[taken_++];
  }
  bool is_exhausted() override { return taken_ == jobs.size(); }
  void took(JobId id) override {
    open_.insert(id);
    most_open = std::max(most_open, open_.size());
  }
  void done(JobId id, Expected<RenderOutcome> outcome) override {
    EXPECT_EQ(open_.erase(id), 1u);
    finished.push_back(id);
    outcomes.emplace(id, std::move(outcome));
  }
  void begin_anew() {
    jobs.clear();
    finished.clear();
    outcomes.clear();
    taken_ = most_open = 0;
  }

 private:
  std::size_t taken_ = 0;
  std::set<JobId> open_;
  std::chrono::steady_clock::time_point next_at_{};
};

class RenderFarmTest : public testing::Test {
 protected:
  void SetUp() override {
    char directory[] = "/tmp/penumbra-test-XXXXXX";
    ASSERT_NE(mkdtemp(directory), nullptr);
    directory_ = directory;
    setenv("XDG_RUNTIME_DIR", directory, 1);
    FakeBehaviour{.delay_ms = 2}.to_environment();
  }
  void TearDown() override {
    FakeBehaviour{}.to_environment();
    std::filesystem::remove_all(directory_);
  }

  Expected<void> run() { return run_farm(options_, source_, stop_); }
  /// Whether the job has come to the film of this shift; and what was said of it.
  void expect_film(JobId id, float shift) {
    const Expected<RenderOutcome>& outcome = source_.outcomes.at(id);
    ASSERT_TRUE(outcome) << outcome.error().message;
    EXPECT_TRUE(outcome->complete);
    EXPECT_EQ(outcome->film.hash(), expected_hash(shift)) << "job " << id;
  }

  FarmOptions options_{.workers = 2, .worker_executable = PENUMBRA_BINARY_DIR "/fake_worker"};
  ListedJobs source_;
  std::atomic<bool> stop_ = false;
  std::string directory_;
};

TEST_F(RenderFarmTest, JobsFollowEachOtherOnTheSameWorkers) {
  constexpr int kJobs = 7;
  for (int i = 0; i < kJobs; ++i) source_.jobs.push_back(job(float(i)));
  ASSERT_TRUE(run());
  std::set<std::string> workers;
  for (JobId id = 1; id <= kJobs; ++id) {
    expect_film(id, float(id - 1));
    EXPECT_THAT(source_.outcomes.at(id)->problems, IsEmpty());
    for (const WorkerShare& share : source_.outcomes.at(id)->workers) workers.insert(share.name);
  }
  EXPECT_LE(workers.size(), 2u) << "none was started anew";
  EXPECT_EQ(source_.most_open, 2u);
}

TEST_F(RenderFarmTest, WorkersWaitForJobsThatTakeTheirTime) {
  source_.gap = 300ms;
  for (int i = 0; i < 3; ++i) source_.jobs.push_back(job(float(i)));
  ASSERT_TRUE(run());
  for (JobId id = 1; id <= 3; ++id) expect_film(id, float(id - 1));
}

/// Jobs that other threads put, which ring after each.
class RungJobs final : public JobSource {
 public:
  static constexpr int kThreads = 3, kJobs = 4;  // of each

  RungJobs() {
    for (int thread = 0; thread < kThreads; ++thread)
      threads_.emplace_back([this, thread] {
        for (int i = 0; i < kJobs; ++i) {
          {
            const std::lock_guard lock(mutex_);
            waiting_.push_back(job(float(thread * kJobs + i)));
          }
          job_signal().notify();
        }
        ++ended_;
        job_signal().notify();
        // Whether or not a farm listens, or still does.
        for (int i = 0; i < 1000; ++i) job_signal().notify();
      });
  }
  ~RungJobs() override {
    for (std::thread& thread : threads_) thread.join();
  }
  std::shared_ptr<const RenderJob> next() override {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return nullptr;
    const auto first = waiting_.back();
    waiting_.pop_back();
    return first;
  }
  bool is_exhausted() override {
    const bool all = ended_ == kThreads;
    const std::lock_guard lock(mutex_);
    return all && waiting_.empty();
  }
  void done(JobId, Expected<RenderOutcome> outcome) override {
    ASSERT_TRUE(outcome) << outcome.error().message;
    hashes.insert(outcome->film.hash());
  }
  std::set<std::uint64_t> hashes;

 private:
  std::mutex mutex_;
  std::vector<std::shared_ptr<const RenderJob>> waiting_;
  std::atomic<int> ended_ = 0;
  std::vector<std::thread> threads_;
};

TEST_F(RenderFarmTest, JobsMayComeFromAnyThreadThatRings) {
  RungJobs jobs;
  ASSERT_TRUE(run_farm(options_, jobs, stop_));
  std::set<std::uint64_t> expected;
  for (int i = 0; i < RungJobs::kThreads * RungJobs::kJobs; ++i) expected.insert(expected_hash(float(i)));
  EXPECT_EQ(jobs.hashes, expected);
}

TEST_F(RenderFarmTest, AHigherPriorityGoesFirst) {
  FakeBehaviour{.delay_ms = 20}.to_environment();
  source_.jobs = {job(1), job(2)};
  const auto urgent = job(3);
  urgent->priority = 1;
  source_.jobs.insert(source_.jobs.begin() + 1, urgent);
  ASSERT_TRUE(run());
  EXPECT_THAT(source_.finished, ElementsAre(2, 1, 3));
  expect_film(1, 1);
  expect_film(2, 3);
  expect_film(3, 2);
}

TEST_F(RenderFarmTest, EqualScenesAreOneAssetUntilTheLastIsDone) {
  source_.jobs = {job(4), job(4), job(4)};
  ASSERT_TRUE(run());
  for (JobId id = 1; id <= 3; ++id) expect_film(id, 4);
}

TEST_F(RenderFarmTest, AJobThatNoWorkerCanDoDoesNotStopTheOthers) {
  // Its scene's tables are not there, which workers find when they check it.
  const auto damaged = job(2);
  damaged->scene.words.clear();
  source_.jobs = {job(1), damaged, job(3)};
  ASSERT_TRUE(run());
  expect_film(1, 1);
  expect_film(3, 3);
  ASSERT_FALSE(source_.outcomes.at(2));
  EXPECT_THAT(source_.outcomes.at(2).error().message, HasSubstr("no worker can do this job"));
}

TEST_F(RenderFarmTest, ASceneThatKillsEveryWorkerConcernsItsJobAlone) {
  for (const int workers : {1, 2, 6}) {
    SCOPED_TRACE(workers);
    source_.begin_anew();
    FakeBehaviour{.delay_ms = 2, .deadly_scene = 2}.to_environment();
    options_.workers = workers;
    source_.jobs = {job(1), job(2), job(3), job(4)};
    ASSERT_TRUE(run());
    for (const JobId id : {1u, 3u, 4u}) expect_film(id, float(id));
    ASSERT_FALSE(source_.outcomes.at(2));
    EXPECT_THAT(source_.outcomes.at(2).error().message, HasSubstr("workers died while they prepared it"));
  }
}

TEST_F(RenderFarmTest, AUnitThatKillsItsWorkersConcernsItsJobAlone) {
  // Only the larger image has this unit.
  FakeBehaviour{.crash_at = "48,0,0"}.to_environment();
  const auto large = job(2);
  large->scene = fake_scene(64, kSize, false);
  large->width = 64;
  source_.jobs = {job(1), large, job(3)};
  ASSERT_TRUE(run());
  expect_film(1, 1);
  expect_film(3, 3);
  const Expected<RenderOutcome>& outcome = source_.outcomes.at(2);
  ASSERT_TRUE(outcome);
  EXPECT_FALSE(outcome->complete);
  EXPECT_EQ(outcome->units_set_aside, 1u);
}

TEST_F(RenderFarmTest, StopEndsWhatIsOpenAndKeepsWhatIsMerged) {
  FakeBehaviour{.delay_ms = 50}.to_environment();
  for (int i = 0; i < 4; ++i) source_.jobs.push_back(job(float(i)));
  std::thread later([&] {
    std::this_thread::sleep_for(600ms);
    stop_ = true;
  });
  EXPECT_TRUE(run());
  later.join();
  EXPECT_LT(source_.outcomes.size(), 4u);
  for (const auto& [id, outcome] : source_.outcomes) ASSERT_TRUE(outcome);
}

TEST_F(RenderFarmTest, WithoutWorkersEveryOpenJobFailsAndTheReasonIsSaid) {
  options_.worker_executable = directory_ + "/no-such-program";
  source_.jobs = {job(1), job(2), job(3)};
  const Expected<void> ran = run();
  ASSERT_FALSE(ran);
  EXPECT_THAT(ran.error().message, HasSubstr("no-such-program"));
  EXPECT_EQ(source_.outcomes.size(), 2u) << "those that were open";
  for (const auto& [id, outcome] : source_.outcomes)
    EXPECT_THAT(outcome.error().message, HasSubstr("no worker could be started"));
}

/// A worker program that is killed before it connects, the first times that it is started.
std::string killed_at_first(const std::filesystem::path& folder, int times) {
  const std::filesystem::path program = folder / "worker.sh", starts = folder / "starts";
  write_text(program, "#!/bin/sh\necho >>" + starts.string() + "\n[ $(wc -l <" + starts.string() + ") -gt " +
                          std::to_string(times) +
                          " ] || kill -KILL $$\nexec " PENUMBRA_BINARY_DIR "/fake_worker \"$@\"\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  return program.string();
}

TEST_F(RenderFarmTest, WorkersThatAreKilledBeforeTheyConnectAreStartedAgain) {
  options_.worker_executable = killed_at_first(directory_, 5);
  source_.jobs = {job(1)};
  ASSERT_TRUE(run());
  expect_film(1, 1);
}

TEST_F(RenderFarmTest, EvenMoreOftenThanAUnitMayKillThem) {
  options_.worker_executable = killed_at_first(directory_, 15);
  source_.jobs = {job(1)};
  ASSERT_TRUE(run());
  expect_film(1, 1);
}

TEST_F(RenderFarmTest, ButNotForEver) {
  options_.workers = 1;
  options_.worker_executable = killed_at_first(directory_, 1000);
  source_.jobs = {job(1)};
  const Expected<void> ran = run();
  ASSERT_FALSE(ran);
  EXPECT_THAT(ran.error().message, HasSubstr("killed by signal 9"));
}

}  // namespace
}  // namespace penumbra::render_farm_test
