// `penumbra render` on a cluster: workers that a command starts, workers with different instruction sets and
// backends, workers that leave, workers that have parts of a scene cached; and estimates of what a render
// takes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/fake_processes.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Arguments = std::vector<std::string>;

constexpr const char* kWorker = PENUMBRA_BINARY_DIR "/penumbra-worker";

class Cluster : public ::testing::Test {
 protected:
  void SetUp() override {
    write_small_scene(folder_ / "s.xml");
    std::string other = file_contents(folder_ / "s.xml");
    const std::string origin = "origin=\"0, 2, -4\"";
    other.replace(other.find(origin), origin.size(), "origin=\"0, 2, -3\"");
    write_text(folder_ / "other.xml", other);
  }
  ProgramResult run(const Arguments& arguments) const { return run_penumbra(folder_.path(), arguments); }
  [[nodiscard]] nlohmann::json statistics(const std::string& name) const {
    return nlohmann::json::parse(file_contents(folder_ / name));
  }
  [[nodiscard]] bool is_same(const std::string& a, const std::string& b) const {
    return file_contents(folder_ / a) == file_contents(folder_ / b);
  }

  TemporaryFolder folder_;
};

/// A second or two.
const Arguments kRender = {"render", "s.xml", "--spp", "40000", "--pass", "32", "--tile", "8", "-q"};

Arguments with(Arguments all, const Arguments& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TEST_F(Cluster, AWorkerMayWaitForEverAndEndsWhenItIsTold) {
  Program worker(folder_.path(), kWorker, {"--connect", "unix:none", "--retry-for", "inf"});
  EXPECT_TRUE(eventually([&] { return file_contents(folder_ / ".stderr").contains("waiting: "); }, 20s))
      << file_contents(folder_ / ".stderr");
  worker.send(SIGTERM);
  EXPECT_EQ(worker.wait().exit_code, 0);
}

TEST_F(Cluster, WorkersOfAllInstructionSetsAndBackendsGiveTheSameBytes) {
  setenv("PENUMBRA_KERNEL_CACHE", (folder_ / "kernels").c_str(), 1);
  const bool has_opencl =
      run({"render", "s.xml", "--spp", "1", "--backend", "opencl", "-q", "-o", "warm.exr"}).exit_code == 0;
  std::vector<std::string> kinds;
  for (const char* set : {"sse2", "avx2", "avx512"})
    if (Program(folder_.path(), kWorker, {"--isa", set, "--connect", "unix:/nowhere", "--retry-for", "0"})
            .wait()
            .exit_code != 2)
      kinds.push_back(std::string("--isa ") + set);
  if (has_opencl) kinds.push_back("--backend opencl");
  std::string script = "#!/bin/sh\n";
  for (const std::string& kind : kinds) script += "\"$@\" " + kind + " &\n";
  write_text(folder_ / "launch.sh", script + "wait\n");
  const ProgramResult there =
      run(with(kRender, {"--launch", "sh launch.sh", "--threads", "1", "-o", "there.exr"}));
  unsetenv("PENUMBRA_KERNEL_CACHE");
  ASSERT_EQ(there.exit_code, 0) << there.err;
  std::vector<std::string> devices;
  const auto json = statistics("there.json");
  for (const auto& worker : json["workers"]) {
    EXPECT_GT(worker["units"], 0) << worker;
    devices.push_back(worker["device"]);
  }
  EXPECT_EQ(devices.size(), kinds.size());
  std::ranges::sort(devices);
  EXPECT_EQ(std::ranges::adjacent_find(devices), devices.end()) << "they differ";
  ASSERT_EQ(run(with(kRender, {"-o", "here.exr"})).exit_code, 0);
  // The backend of the job is the same, native; which workers there were is no part of an image.
  EXPECT_TRUE(is_same("here.exr", "there.exr"));
}

TEST_F(Cluster, AWorkerThatIsToldToEndLeavesAndIsBlamedForNothing) {
  Program program(folder_.path(), with({"render", "s.xml", "--spp", "40000", "--pass", "32", "--tile", "8"},
                                       {"--workers", "2", "--threads", "1", "-o", "left.exr"}));
  int ended = 0;
  for (; ended < 4; ++ended) {
    std::vector<pid_t> workers;
    ASSERT_TRUE(eventually([&] { return (workers = children_of(program.pid())).size() == 2; }, 10s));
    std::this_thread::sleep_for(150ms);
    kill(workers[0], SIGTERM);
    EXPECT_TRUE(eventually([&] { return process_state(workers[0]) == 0; }, 2s));
  }
  const ProgramResult result = program.wait();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("has left: it was told to end by a signal"), Not(HasSubstr("warning"))));
  ASSERT_EQ(run(with(kRender, {"-o", "here.exr"})).exit_code, 0);
  EXPECT_TRUE(is_same("here.exr", "left.exr"));
}

TEST_F(Cluster, AnotherCameraOfASetShipsNoGeometryAgain) {
  const ProgramResult result = run({"render", "s.xml", "other.xml", "-o", "out/", "--spp", "4000", "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto first = statistics("out/s.json")["workers"][0]["scene_bytes"];
  const auto second = statistics("out/other.json")["workers"][0]["scene_bytes"];
  EXPECT_EQ(first["found"], 0);
  EXPECT_GT(first["fetched"], 4000);
  EXPECT_GT(second["found"], 4000);
  EXPECT_LT(second["fetched"], 1000) << "its header alone";
}

TEST_F(Cluster, ACacheServesTheWorkersOfTheNextRender) {
  const Arguments launch = {"--launch", "env PENUMBRA_CACHE=cache", "--spp", "16", "-q"};
  for (const auto& [scene, fetched_before] : {std::pair{"s", false}, {"s", true}, {"other", true}}) {
    const ProgramResult result = run(with({"render", std::string(scene) + ".xml"}, launch));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto bytes = statistics(std::string(scene) + ".json")["workers"][0]["scene_bytes"];
    EXPECT_EQ(bytes["found"] > 4000, fetched_before) << scene;
    EXPECT_EQ(bytes["fetched"] < 1000, fetched_before) << scene;
  }
  // Damaged, it is as good as none.
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "cache"))
    write_text(entry.path(), "no");
  const ProgramResult result = run(with({"render", "s.xml", "-o", "again.exr"}, launch));
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("was damaged and is removed"));
  EXPECT_TRUE(is_same("s.exr", "again.exr"));
}

TEST_F(Cluster, ALauncherThatCannotIsSaidAndNotTriedForEver) {
  const ProgramResult result = run({"render", "s.xml", "--launch", "no-such-launcher -n 3"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("no worker could be started"),
                                HasSubstr("the launcher of workers ended: exit code 127")));
  EXPECT_EQ(run({"render", "s.xml", "--launch", "srun", "--workers", "2"}).exit_code, 2);
}

TEST_F(Cluster, AnEstimateSaysWhatTheRenderThenTakes) {
  const Arguments job = {"render", "s.xml", "--spp", "2000", "--tile", "16", "--pass", "64"};
  const ProgramResult estimated = run(with(job, {"--estimate", "--json"}));
  ASSERT_EQ(estimated.exit_code, 0) << estimated.err;
  EXPECT_THAT(folder_.names(), ElementsAre("other.xml", "s.xml")) << "no image";
  const auto json = nlohmann::json::parse(estimated.out);
  const auto plan = json["plan"];
  constexpr int kPixels = 24 * 20, kPasses = 32, kTiles = 4;  // 2000 / 64, 2 x 2
  EXPECT_EQ(plan["samples"], kPixels * 2000);
  EXPECT_EQ(plan["tiles"], kTiles);
  EXPECT_EQ(plan["passes"], kPasses);
  EXPECT_EQ(plan["units"], kTiles * kPasses);
  ASSERT_EQ(plan["result_bytes"].get<std::uint64_t>() % (kPixels * kPasses * sizeof(float)), 0u) << "planes";

  ASSERT_EQ(run(with(job, {"-q"})).exit_code, 0);
  const auto render = statistics("s.json");
  EXPECT_EQ(render["units"]["done"], plan["units"]);
  const auto estimate = json["estimate"];
  // The error of 2000 samples, which it has rendered all, or fewer where the machine is slow.
  const double error = estimate["relative_error"], real_error = render["relative_error"];
  EXPECT_NEAR(error / real_error, 1, 0.5);
  // Of a busy machine more cannot be said.
  const auto worker = render["workers"][0];
  const double core_seconds =
      worker["busy_seconds"].get<double>() * json["measured"]["threads"].get<double>();
  EXPECT_GT(estimate["core_seconds"].get<double>(), core_seconds / 10);
  EXPECT_LT(estimate["core_seconds"].get<double>(), core_seconds * 10);
  EXPECT_NEAR(estimate["cores_of_a_gigabit"].get<double>() * plan["result_bytes"].get<double>() /
                  estimate["core_seconds"].get<double>(),
              1e9 / 8, 1);
  double before = 1e30;
  for (const auto& wall : estimate["wall"]) {
    EXPECT_LE(wall["seconds"].get<double>(), before);
    before = wall["seconds"];
  }
}

TEST_F(Cluster, AnEstimateIsBoundedHoweverLargeTheJob) {
  const auto begin = std::chrono::steady_clock::now();
  const ProgramResult result = run({"render", "s.xml", "--spp", "1000000000", "--estimate", "--set",
                                    "film.width=1200", "--set", "film.height=1000"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("core-hours"), HasSubstr("with 128 x")));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 60s) << "of a busy machine; some ten else";
  const ProgramResult cropped =
      run({"render", "s.xml", "--spp", "1000000000", "--estimate", "--json", "--set", "film.width=6000",
           "--set", "film.height=5000", "--crop", "1000,500,5000,3000"});
  ASSERT_EQ(cropped.exit_code, 0) << cropped.err;
  const auto measured = nlohmann::json::parse(cropped.out)["measured"];
  const double width = measured["width"], height = measured["height"];
  EXPECT_LT(width, 4000) << "a smaller image";
  EXPECT_NEAR(width / height, 4000.0 / 2500, 0.15);
  EXPECT_TRUE(measured["relative_error"].is_number());
}

}  // namespace
}  // namespace penumbra
