// One job from its submission to its film. Worker processes and connections are real; only the device is a
// fake.
#include "scheduler/farm/render_farm.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "kernels/host/process.h"
#include "scheduler/farm/render_job_check.h"
#include "scheduler/farm/worker_isa.h"
#include "scheduler/plan/adaptive_tile.h"
#include "scheduler/plan/render_memory.h"
#include "tests/support/fake_device.h"
#include "tests/support/fake_processes.h"
#include "tests/support/fake_samples.h"
#include "tests/support/local_render.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::AllOf;
using testing::Contains;
using testing::ContainsRegex;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kX = 8, kY = 4, kWidth = 120, kHeight = 100;
constexpr std::uint32_t kSpp = 10, kSamplesPerPass = 4;

class RenderJobTest : public testing::Test {
 protected:
  void SetUp() override {
    char directory[] = "/tmp/penumbra-test-XXXXXX";
    ASSERT_NE(mkdtemp(directory), nullptr);
    directory_ = directory;
    setenv("XDG_RUNTIME_DIR", directory, 1);  // so that the test sees what is left there
    FakeBehaviour{}.to_environment();
  }
  void TearDown() override {
    EXPECT_THAT(children_of(getpid()), IsEmpty()) << "a worker is still there";
    EXPECT_TRUE(sockets_left().empty()) << sockets_left()[0];
    FakeBehaviour{}.to_environment();
    fs::remove_all(directory_);
  }

  std::vector<std::string> sockets_left() const {
    std::vector<std::string> left;
    for (const auto& entry : fs::directory_iterator(directory_)) {
      if (entry.is_directory()) left.push_back(entry.path());
    }
    return left;
  }

  static LocalRender job(int workers = 2, int tile = 16) {
    LocalRender job;
    job.scene = fake_scene(200, 150, true);
    job.x = kX;
    job.y = kY;
    job.width = kWidth;
    job.height = kHeight;
    job.spp = kSpp;
    job.request.plan.samples_per_pass = kSamplesPerPass;
    job.request.plan.tile = tile;
    job.workers = workers;
    job.worker_executable = PENUMBRA_BINARY_DIR "/fake_worker";
    job.reproduce_command = "penumbra render 'a scene.xml' --seed 3";
    return job;
  }

  static Expected<RenderOutcome> render(const LocalRender& job) {
    const std::atomic<bool> stop = false;
    return run_render(job, stop, {});
  }

  /// The same film without scheduler, workers and wire.
  static std::uint64_t expected_hash() {
    FilmAccumulator film(kX, kY, kWidth, kHeight, kFeatureLayers);
    for (std::uint32_t first = 0; first < kSpp; first += kSamplesPerPass) {
      const RenderUnit unit{kX, kY, kWidth, kHeight, first, std::min(kSamplesPerPass, kSpp - first)};
      film.add(kX, kY, fake_samples(unit, kFeatureLayers));
    }
    return film.hash();
  }

  static void expect_the_right_film(const Expected<RenderOutcome>& outcome) {
    ASSERT_TRUE(outcome) << outcome.error().message;
    EXPECT_TRUE(outcome->complete);
    EXPECT_EQ(outcome->film.hash(), expected_hash());
  }

  std::string claim_file() const { return directory_ + "/claim"; }

  std::string directory_;
};

TEST_F(RenderJobTest, TheFilmIsTheSameForAnyNumberOfWorkers) {
  FakeBehaviour{.delay_ms = 5}.to_environment();
  for (const int workers : {1, 2, 5}) {
    SCOPED_TRACE(workers);
    const Expected<RenderOutcome> outcome = render(job(workers));
    expect_the_right_film(outcome);
    EXPECT_THAT(outcome->problems, IsEmpty());
    EXPECT_EQ(outcome->units_done, 8u * 7 * 3);
    EXPECT_EQ(outcome->passes_finished, 3u);
    EXPECT_LE(outcome->workers.size(), std::size_t(workers));
    std::uint64_t samples = 0;
    int busy = 0;
    for (const WorkerShare& share : outcome->workers) {
      samples += share.samples;
      if (share.units == 0) continue;  // it came too late
      ++busy;
      EXPECT_EQ(share.device, "fake");
      EXPECT_GT(share.busy_seconds, 0);
      EXPECT_GT(share.peak_memory_bytes, 1u << 20);
    }
    EXPECT_GE(busy, std::min(workers, 2));
    EXPECT_EQ(samples, std::uint64_t(kWidth) * kHeight * kSpp);
  }
}

/// VmHWM of a process in bytes; 0 if it is gone.
std::uint64_t proc_peak(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
  return 0;
}

TEST_F(RenderJobTest, AWorkersMemoryIsItsOwn) {
  FakeBehaviour{.delay_ms = 5}.to_environment();
  // Of the scheduler's memory the child has a view from fork to exec.
  constexpr std::size_t kBallast = std::size_t(768) << 20;
  void* ballast =
      mmap(nullptr, kBallast, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
  ASSERT_NE(ballast, MAP_FAILED);
  std::uint64_t seen = 0;
  const std::atomic<bool> stop = false;
  const Expected<RenderOutcome> outcome = run_render(job(1), stop, [&](const RenderProgress& progress) {
    if (progress.samples_done > 0)
      for (const pid_t child : children_of(getpid())) seen = std::max(seen, proc_peak(child));
  });
  munmap(ballast, kBallast);
  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_EQ(outcome->workers.size(), 1u);
  ASSERT_GT(seen, 0u);
  EXPECT_GE(outcome->workers[0].peak_memory_bytes, seen / 2);
  EXPECT_LT(outcome->workers[0].peak_memory_bytes, kBallast);
  EXPECT_GT(peak_memory_bytes(), kBallast) << "of this process itself";
}

TEST_F(RenderJobTest, TheFilmIsTheSameForAnyTileSize) {
  for (const int tile : {16, 64, 61, 1000}) {
    SCOPED_TRACE(tile);
    expect_the_right_film(render(job(2, tile)));
  }
}

TEST_F(RenderJobTest, ASceneOfManyChunksArrivesWhole) {
  LocalRender big = job(2);
  big.scene.words.resize(3'000'000);  // 12 MB
  std::iota(big.scene.words.begin() + 1024, big.scene.words.end(), 0u);
  expect_the_right_film(render(big));
}

TEST_F(RenderJobTest, AKilledAndAStoppedWorkerChangeNothing) {
  // Slow enough that the worker in the killed one's place is there before the end.
  FakeBehaviour{.delay_ms = 30}.to_environment();
  std::vector<pid_t> victims;
  const std::atomic<bool> stop = false;
  const Expected<RenderOutcome> outcome = run_render(job(3), stop, [&](const RenderProgress& progress) {
    if (!victims.empty() || progress.workers < 3 || progress.samples_done == 0) return;
    victims = children_of(getpid());
    ASSERT_THAT(victims, SizeIs(3));
    kill(victims[0], SIGKILL);
    kill(victims[1], SIGSTOP);
  });
  ASSERT_THAT(victims, SizeIs(3)) << "the render was over before a worker could be killed";
  expect_the_right_film(outcome);
  EXPECT_THAT(outcome->problems,
              Contains(AllOf(HasSubstr(std::to_string(victims[0]) + " was lost at the tile of"),
                             HasSubstr("signal 9"))));
  EXPECT_EQ(process_state(victims[1]), 0) << "the stopped worker is still there";
  EXPECT_GE(outcome->units_requeued, 1u);
  EXPECT_GE(outcome->units_duplicated, 1u);
  EXPECT_EQ(outcome->workers.size(), 4u) << "the killed worker was replaced";
}

TEST_F(RenderJobTest, AUnitThatKillsThreeWorkersIsNamedAndTheRestCompletes) {
  const int x = kX + 32, y = kY + 16;
  FakeBehaviour{.crash_at = std::to_string(x) + "," + std::to_string(y) + ",4"}.to_environment();
  for (const int workers : {1, 2}) {
    SCOPED_TRACE(workers);
    const Expected<RenderOutcome> outcome = render(job(workers));
    ASSERT_TRUE(outcome) << outcome.error().message;
    EXPECT_FALSE(outcome->complete);
    EXPECT_EQ(outcome->units_done, 8u * 7 * 3 - 1);
    EXPECT_THAT(outcome->problems,
                Contains(AllOf(HasSubstr("16 x 16 pixels at (40, 20), samples 4 to 7"),
                               HasSubstr("penumbra render 'a scene.xml' --seed 3 --crop 40,20,56,36"))));
    for (int py = kY; py < kY + kHeight; ++py) {
      for (int px = kX; px < kX + kWidth; ++px) {
        const bool missing = px >= x && px < x + 16 && py >= y && py < y + 16;
        ASSERT_EQ(outcome->film.at(px, py).count, missing ? kSpp - kSamplesPerPass : kSpp);
      }
    }
  }
}

TEST_F(RenderJobTest, AUnitThatTheDeviceCannotRenderIsNamed) {
  FakeBehaviour{.fail_at = "8,4,0"}.to_environment();
  const Expected<RenderOutcome> outcome = render(job(2));
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_FALSE(outcome->complete);
  EXPECT_EQ(outcome->units_done, 8u * 7 * 3 - 1);
  EXPECT_THAT(outcome->problems,
              Contains(AllOf(HasSubstr("the fake device was told to fail"), HasSubstr("--crop 8,4,24,20"))));
}

TEST_F(RenderJobTest, ALiarIsFoundOutAndItsWorkRedone) {
  // The liar is late with its first unit, so that the other worker renders that too and the results are
  // compared.
  FakeBehaviour{.delay_ms = 15, .lie_claim = claim_file(), .liar_delay_ms = 1500}.to_environment();
  LocalRender lied_to = job(2);
  lied_to.leases = {.initial = 1, .minimum = 1, .factor = 1, .growth = 1};
  const Expected<RenderOutcome> outcome = render(lied_to);
  expect_the_right_film(outcome);
  EXPECT_THAT(outcome->problems, Contains(HasSubstr("different results")).Times(2));
  EXPECT_EQ(outcome->workers.size(), 4u) << "both are replaced";
}

TEST_F(RenderJobTest, AJobThatThreeWorkersDiedOfGoesOnIfAnotherOneIsReadyForIt) {
  // Their processes are there for a while when their connections are not, and the fourth one is ready before
  // it is known how they ended.
  FakeBehaviour{.delay_ms = 200, .vanish_claim = claim_file(), .prepare_ms = 500}.to_environment();
  LocalRender deadly = job(4, 25);
  const Expected<RenderOutcome> outcome = render(deadly);
  expect_the_right_film(outcome);
  EXPECT_GE(outcome->seconds, 2) << "it was over before the processes were";
}

TEST_F(RenderJobTest, ALiarIsFoundOutByUnitsThatTwoWorkersDo) {
  FakeBehaviour{.delay_ms = 5, .lie_claim = claim_file()}.to_environment();
  LocalRender verified = job(3);
  verified.request.verify = 0.3;
  const Expected<RenderOutcome> outcome = render(verified);
  expect_the_right_film(outcome);
  EXPECT_THAT(outcome->problems, Contains(HasSubstr("different results")).Times(2));
  EXPECT_GT(outcome->units_verified, 20u);
  EXPECT_EQ(outcome->units_not_verified, 0u);
}

TEST_F(RenderJobTest, ADamagedResultIsRejectedAndRedone) {
  FakeBehaviour{.damage_claim = claim_file()}.to_environment();
  const Expected<RenderOutcome> outcome = render(job(2));
  expect_the_right_film(outcome);
  EXPECT_THAT(outcome->problems, Contains(HasSubstr("damaged result")));
}

TEST_F(RenderJobTest, ANaNThatNoCounterExplainsIsADamagedResult) {
  FakeBehaviour{.nan_claim = claim_file()}.to_environment();
  const Expected<RenderOutcome> outcome = render(job(2));
  expect_the_right_film(outcome);
  EXPECT_THAT(outcome->problems,
              Contains(AllOf(HasSubstr("damaged result"), HasSubstr("the result has nan as a"))));
}

TEST_F(RenderJobTest, AHungWorkerDoesNotHoldUpTheRender) {
  FakeBehaviour{.delay_ms = 1, .hang_claim = claim_file()}.to_environment();
  const Expected<RenderOutcome> outcome = render(job(2));
  expect_the_right_film(outcome);
}

TEST_F(RenderJobTest, ALonelyHungWorkerIsReplaced) {
  FakeBehaviour{.hang_claim = claim_file()}.to_environment();
  LocalRender alone = job(1);
  alone.leases = {.initial = 0.3, .minimum = 0.3, .factor = 20, .growth = 2};
  const Expected<RenderOutcome> outcome = render(alone);
  expect_the_right_film(outcome);
  EXPECT_THAT(outcome->problems, Contains(HasSubstr("hung")));
  EXPECT_EQ(outcome->workers.size(), 2u);
}

TEST_F(RenderJobTest, AWorkerThatIsStoppedInItsFirstUnitIsToldAndReplaced) {
  // The first unit takes longer than the lease, and is none the worse for it: only the first process is
  // stopped.
  FakeBehaviour{.delay_ms = 1500}.to_environment();
  LocalRender alone = job(1, 1000);
  alone.leases = {.initial = 600, .minimum = 600, .silence = 3, .patience = 2};
  std::vector<pid_t> victims;
  std::string notices;
  const std::atomic<bool> stop = false;
  const Expected<RenderOutcome> outcome = run_render(alone, stop, [&](const RenderProgress& progress) {
    for (const std::string& notice : progress.notices) notices += notice + "\n";
    if (!victims.empty() || progress.workers < 1) return;
    victims = children_of(getpid());
    ASSERT_THAT(victims, SizeIs(1));
    kill(victims[0], SIGSTOP);
  });
  ASSERT_THAT(victims, SizeIs(1)) << "the render was over before a worker could be stopped";
  expect_the_right_film(outcome);
  EXPECT_THAT(notices, AllOf(ContainsRegex("waiting for worker [^ ]+:" + std::to_string(victims[0])),
                             HasSubstr("has not been heard of for 2 s at the tile of 120 x 100 pixels")));
  EXPECT_THAT(outcome->problems,
              Contains(AllOf(HasSubstr(std::to_string(victims[0])), HasSubstr("was ended: it hung"))));
  EXPECT_EQ(outcome->workers.size(), 2u);
}

TEST_F(RenderJobTest, AUnitThatTakesLongerThanItsLeaseButGetsOnIsWaitedFor) {
  FakeBehaviour{.delay_ms = 4000}.to_environment();
  LocalRender slow = job(1, 1000);
  slow.spp = kSamplesPerPass;
  slow.leases = {.initial = 2.5, .minimum = 2.5, .factor = 1};
  const Expected<RenderOutcome> outcome = render(slow);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(outcome->complete);
  EXPECT_THAT(outcome->problems, IsEmpty());
  EXPECT_EQ(outcome->units_requeued, 0u);
}

TEST_F(RenderJobTest, StopKeepsWhatIsMerged) {
  FakeBehaviour{.delay_ms = 20}.to_environment();
  std::atomic<bool> stop = false;
  std::chrono::steady_clock::time_point stopped_at;
  const Expected<RenderOutcome> outcome = run_render(job(2), stop, [&](const RenderProgress& progress) {
    if (stop || progress.samples_done == 0) return;
    stop = true;
    stopped_at = std::chrono::steady_clock::now();
  });
  EXPECT_LT(std::chrono::steady_clock::now() - stopped_at, 5s);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_FALSE(outcome->complete);
  EXPECT_GT(outcome->units_done, 0u);
  EXPECT_LT(outcome->units_done, 8u * 7 * 3);
  std::uint64_t samples = 0;
  for (int y = kY; y < kY + kHeight; ++y) {
    for (int x = kX; x < kX + kWidth; ++x) samples += outcome->film.at(x, y).count;
  }
  EXPECT_GT(samples, 0u);
}

TEST_F(RenderJobTest, AStopBeforeTheStartIsNoError) {
  const std::atomic<bool> stop = true;
  const Expected<RenderOutcome> outcome = run_render(job(2), stop, {});
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_FALSE(outcome->complete);
}

TEST_F(RenderJobTest, ATimeBudgetEndsAfterAWholePass) {
  FakeBehaviour{.delay_ms = 2}.to_environment();
  LocalRender hurried = job(2);
  hurried.request.time_budget = 0.0;
  const Expected<RenderOutcome> outcome = render(hurried);
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_TRUE(outcome->complete);
  EXPECT_EQ(outcome->passes_finished, 1u);
  EXPECT_EQ(outcome->passes_total, 3u);
  EXPECT_EQ(outcome->film.at(kX, kY).count, kSamplesPerPass);
}

TEST_F(RenderJobTest, ProgressGrowsToTheEnd) {
  FakeBehaviour{.delay_ms = 10}.to_environment();
  std::vector<RenderProgress> seen;
  const std::atomic<bool> stop = false;
  const Expected<RenderOutcome> outcome =
      run_render(job(2), stop, [&](const RenderProgress& progress) { seen.push_back(progress); });
  expect_the_right_film(outcome);
  ASSERT_GE(seen.size(), 3u);
  EXPECT_TRUE(std::ranges::is_sorted(seen, {}, &RenderProgress::samples_done));
  EXPECT_TRUE(std::ranges::is_sorted(seen, {}, &RenderProgress::elapsed_seconds));
  EXPECT_EQ(seen.back().samples_done, std::uint64_t(kWidth) * kHeight * kSpp);
  EXPECT_EQ(seen.back().samples_total, seen.back().samples_done);
  EXPECT_EQ(seen.back().relative_error, outcome->film.relative_error());
  EXPECT_GT(outcome->seconds_to_first_tile, 0);
  EXPECT_LT(outcome->seconds_to_first_tile, outcome->seconds);
}

// --- Jobs that cannot work end with an error instead of going on for ever

TEST_F(RenderJobTest, AMissingWorkerProgramIsAnError) {
  LocalRender missing = job();
  missing.worker_executable = directory_ + "/no-such-program";
  const Expected<RenderOutcome> outcome = render(missing);
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().message, AllOf(HasSubstr("no-such-program"), HasSubstr("No such file")));
}

TEST_F(RenderJobTest, WorkersThatDieAtOnceAreAnError) {
  FakeBehaviour{.die_at_start = 1}.to_environment();
  const Expected<RenderOutcome> outcome = render(job());
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().message, HasSubstr("exit code 3"));
}

TEST_F(RenderJobTest, AJobThatNoWorkerCanDoIsAnError) {
  FakeBehaviour{.no_device = 1}.to_environment();
  const Expected<RenderOutcome> outcome = render(job());
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().message, HasSubstr("there is no fake device today"));
}

// --- Instruction sets: a part of the image with Embree, and of no matter to it otherwise

TEST_F(RenderJobTest, AnEmbreeJobRefusesWorkersWithoutItsInstructionSet) {
  FakeBehaviour{.isas = 2}.to_environment();  // sse2 and avx2
  LocalRender wide = job();
  ASSERT_EQ(wide.scene.header.intersector, INTERSECTOR_EMBREE);
  wide.device.isa = Isa::kAvx512;
  const Expected<RenderOutcome> outcome = render(wide);
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().message,
              AllOf(ContainsRegex("worker [^ ]+:[0-9]+ was refused"), HasSubstr("Embree with avx512"),
                    HasSubstr("the worker has sse2, avx2"), HasSubstr("--isa")));
  wide.device.isa = Isa::kAvx2;
  expect_the_right_film(render(wide));
}

TEST_F(RenderJobTest, APortableJobTakesWorkersOfEveryInstructionSet) {
  FakeBehaviour{.isas = 1}.to_environment();
  LocalRender portable = job();
  portable.scene.header.intersector = INTERSECTOR_PORTABLE;
  portable.device.isa = Isa::kAvx512;
  const Expected<RenderOutcome> outcome = render(portable);
  expect_the_right_film(outcome);
  EXPECT_THAT(outcome->problems, IsEmpty());
}

TEST(WorkerIsa, IsTheJobsOrTheNearestOrAReasonToRefuse) {
  const auto isa = [](Isa job, bool embree, std::vector<Isa> has) {
    const auto options = options_for_worker({.isa = job}, embree, has, "a:1");
    return options ? std::string(isa_name(options->isa)) : options.error().message;
  };
  const std::vector<Isa> old{Isa::kSse2, Isa::kAvx2}, all{Isa::kSse2, Isa::kAvx2, Isa::kAvx512};
  for (const bool embree : {false, true}) {
    EXPECT_EQ(isa(Isa::kAvx512, embree, all), "avx512");
    EXPECT_EQ(isa(Isa::kSse2, embree, all), "sse2") << "the job's, not the best";
  }
  EXPECT_EQ(isa(Isa::kAvx512, false, old), "avx2");
  EXPECT_EQ(isa(Isa::kSse2, false, {Isa::kAvx2, Isa::kAvx512}), "avx2") << "it has none below";
  EXPECT_EQ(isa(Isa::kAvx512, false, {}), "avx512") << "the worker says itself what it lacks";
  EXPECT_THAT(isa(Isa::kAvx512, true, old),
              AllOf(HasSubstr("worker a:1"), HasSubstr("has sse2, avx2"), HasSubstr("with avx512")));
  EXPECT_THAT(isa(Isa::kAvx2, true, {}), HasSubstr("has none that it names"));
  DeviceOptions opencl{.backend = Backend::kOpenCl, .isa = Isa::kAvx512};
  EXPECT_TRUE(options_for_worker(opencl, false, {}, "a:1")) << "OpenCL kernels have no set";
}

TEST_F(RenderJobTest, WorkersThatFailAtEverythingEndTheRender) {
  FakeBehaviour{.fail_always = 1}.to_environment();
  const Expected<RenderOutcome> outcome = render(job());
  ASSERT_TRUE(outcome) << outcome.error().message;
  EXPECT_FALSE(outcome->complete);
  EXPECT_EQ(outcome->units_done, 0u);
  EXPECT_THAT(outcome->problems, Contains(HasSubstr("units in a row failed")));
}

TEST_F(RenderJobTest, NonsenseIsRefusedInWords) {
  const auto refused = [](auto change) {
    LocalRender nonsense = job();
    change(nonsense);
    const Expected<RenderOutcome> outcome = render(nonsense);
    return outcome ? std::string("accepted") : outcome.error().message;
  };
  EXPECT_THAT(refused([](LocalRender& j) { j.width = 0; }), HasSubstr("0 x 100 pixels"));
  EXPECT_THAT(refused([](LocalRender& j) { j.x = 100; }), HasSubstr("not inside the film of 200 x 150"));
  EXPECT_THAT(refused([](LocalRender& j) { j.x = -1; }), HasSubstr("not inside the film"));
  EXPECT_THAT(refused([](LocalRender& j) { j.request.plan.tile = 0; }),
              HasSubstr("tiles of 0 pixels; 1 to 2048"));
  EXPECT_THAT(refused([](LocalRender& j) { j.request.plan.tile = 5000; }),
              HasSubstr("tiles of 5000 pixels; 1 to 2048"));
  EXPECT_THAT(refused([](LocalRender& j) { j.spp = 0; }), HasSubstr("0 samples per pixel"));
  EXPECT_THAT(refused([](LocalRender& j) { j.request.plan.samples_per_pass = 4097; }),
              HasSubstr("1 to 4096"));
  EXPECT_THAT(refused([](LocalRender& j) { j.workers = 0; }), HasSubstr("0 workers"));
  EXPECT_THAT(refused([](LocalRender& j) {
                j.scene.header.film.width = j.scene.header.film.height = 1 << 20;
                j.x = j.y = 0;
                j.width = j.height = 1 << 20;
                j.request.plan.tile = 1024;
              }),
              HasSubstr("GB"));
}

TEST_F(RenderJobTest, TheSamplesOfAPassShareAPhotonMap) {
  LocalRender photons = job(3);
  IntegratorParameters& integrator = photons.scene.header.integrator;
  integrator.photons = PHOTONS_PROGRESSIVE;
  integrator.samples_per_map = 1;
  ASSERT_FALSE(check_render_job(photons));
  EXPECT_THAT(check_render_job(photons).error().message,
              HasSubstr("passes of 4 samples in a scene with a photon map for every 1"));
  integrator.samples_per_map = int(kSamplesPerPass);
  EXPECT_GT(passes_at_once(photons), 1u);
  EXPECT_TRUE(check_render_job(photons));
  integrator.photons = PHOTONS_FIXED;  // one map, whatever the passes
  integrator.samples_per_map = 0;
  EXPECT_EQ(passes_at_once(photons), 1u);
  EXPECT_TRUE(check_render_job(photons));
  for (const int kind : {PHOTONS_FIXED, PHOTONS_PROGRESSIVE}) {
    integrator.photons = kind;
    integrator.samples_per_map = int(kSamplesPerPass);
    photons.request.plan.adaptive = true;
    ASSERT_FALSE(check_render_job(photons));
    EXPECT_THAT(check_render_job(photons).error().message, HasSubstr("--adaptive"));
    photons.request.plan.adaptive = false;
    photons.request.plan.target_error = 0.1;
    EXPECT_TRUE(check_render_job(photons));
    photons.request.plan.target_error.reset();
  }
}

TEST_F(RenderJobTest, PassesSideBySideFitIntoMemory) {
  LocalRender photons = job();
  EXPECT_EQ(passes_at_once(photons), 1u) << "without photons nothing is shared";
  photons.scene.header.integrator.photons = PHOTONS_PROGRESSIVE;
  EXPECT_EQ(passes_at_once(photons), 64u);
  photons.width = photons.height = 1;
  photons.request.plan.tile = 1;
  EXPECT_EQ(passes_at_once(photons), 64u);
  photons.interactive = true;
  EXPECT_EQ(passes_at_once(photons), 1u);
  photons.interactive = false;
  photons.width = photons.height = 2048;  // as many tiles as there may be
  EXPECT_EQ(passes_at_once(photons), 1u);
  photons.request.plan.tile = 1024;
  const double memory = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
  const double bytes_per_pixel = plane_count(photons.scene.header.features) * sizeof(float);
  photons.width = photons.height = int(std::sqrt(memory / 4 / 2.5 / bytes_per_pixel));
  EXPECT_EQ(passes_at_once(photons), 2u);
  photons.width = photons.height = 2 * photons.width;
  EXPECT_EQ(passes_at_once(photons), 1u);
}

TEST_F(RenderJobTest, MemoryIsCountedWithLayersAndFiles) {
  LocalRender large = job();
  const double memory = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
  const auto fits = [&](double bytes_per_pixel) {
    const int side = int(std::sqrt(memory / bytes_per_pixel));
    large.scene.header.film.width = large.scene.header.film.height = large.width = large.height = side;
    large.x = large.y = 0;
    large.request.plan.tile = 1024;
    return check_render_job(large);
  };
  const double whole = double(pixel_memory(kFeatureLayers).peak(true));
  EXPECT_TRUE(fits(1.01 * whole));
  ASSERT_FALSE(fits(0.99 * whole));
  EXPECT_THAT(fits(0.99 * whole).error().message, AllOf(HasSubstr("GB"), HasSubstr("--no-features")));
  EXPECT_FALSE(fits(2.0 * sizeof(PixelStatistics))) << "twice what radiance alone takes";
  large.request.plan.target_error = 0.1;
  EXPECT_FALSE(fits(1.01 * whole));
  EXPECT_TRUE(fits(1.01 * double(pixel_memory(kFeatureLayers).peak(true, AdaptiveTile::kMostFilms))));
  large.request.plan.target_error.reset();
  large.interactive = true;  // writes no files
  EXPECT_TRUE(fits(0.99 * whole));
}

// --- No orphans

TEST_F(RenderJobTest, WorkersDieWithAKilledScheduler) {
  FakeBehaviour{.delay_ms = 50}.to_environment();
  const std::string worker = job().worker_executable;
  const pid_t scheduler = fork();
  if (scheduler == 0) {
    execl(PENUMBRA_BINARY_DIR "/fake_scheduler", "fake_scheduler", worker.c_str(), nullptr);
    _exit(127);
  }
  std::vector<pid_t> workers;
  ASSERT_TRUE(eventually(
      [&] {
        workers = children_of(scheduler);
        return workers.size() == 3;
      },
      60s));
  kill(workers[0], SIGSTOP);  // even this one must not stay
  kill(scheduler, SIGKILL);
  waitpid(scheduler, nullptr, 0);
  for (const pid_t pid : workers) {
    EXPECT_TRUE(eventually([&] { return process_state(pid) == 0 || process_state(pid) == 'Z'; }, 30s));
  }

  // What a killed scheduler leaves in the file system goes with the next render, once it is old enough.
  ASSERT_THAT(sockets_left(), SizeIs(1));
  const fs::path left = sockets_left()[0];
  fs::last_write_time(left, fs::file_time_type::clock::now() - 1h);
  FakeBehaviour{}.to_environment();
  expect_the_right_film(render(job(1)));
  EXPECT_FALSE(fs::exists(left));
}

}  // namespace
}  // namespace penumbra
