// Passes and tiles of photon mapping in all programs that render: with ppm the samples of a pass share a
// photon map, wherever its number comes from.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "tests/scheduler/cli/killed_render.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

using Arguments = std::vector<std::string>;

class PhotonPlan : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }

  ProgramResult run(const Arguments& arguments) const { return run_penumbra(folder_.path(), arguments); }
  ProgramResult render(const Arguments& more) const {
    Arguments arguments{"render", "s.xml", "-q"};
    const auto unless_given = [&](const std::string& option, const std::string& value) {
      if (std::ranges::find(more, option) == more.end()) arguments.insert(arguments.end(), {option, value});
    };
    unless_given("--integrator", "ppm");
    unless_given("--spp", "8");
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  /// That s.exr is what an undisturbed render makes.
  void expect_image_of(Arguments more) {
    more.insert(more.end(), {"-o", "undisturbed.exr"});
    ASSERT_EQ(render(more).exit_code, 0);
    EXPECT_TRUE(contents("undisturbed.exr") == contents("s.exr"));
  }
  [[nodiscard]] nlohmann::json json(const std::string& name) const {
    return nlohmann::json::parse(file_contents(folder_ / name));
  }
  [[nodiscard]] std::string contents(const std::string& name) const { return file_contents(folder_ / name); }

  TemporaryFolder folder_;
};

TEST_F(PhotonPlan, HasItsOwnDefaults) {
  ASSERT_EQ(render({}).exit_code, 0);
  EXPECT_EQ(json("s.json")["settings"]["samples_per_pass"], 1);
  EXPECT_EQ(json("s.json")["settings"]["tile"], 256);
  EXPECT_EQ(json("s.json")["units"]["done"], 8);
  ASSERT_EQ(render({"--pass", "3", "--tile", "8", "-o", "a.exr"}).exit_code, 0);
  EXPECT_EQ(json("a.json")["settings"]["samples_per_pass"], 3);
  EXPECT_EQ(json("a.json")["settings"]["tile"], 8);
  for (const char* other : {"path", "photonmapper"}) {
    ASSERT_EQ(run({"render", "s.xml", "--integrator", other, "-q", "-o", "b.exr"}).exit_code, 0) << other;
    EXPECT_EQ(json("b.json")["settings"]["samples_per_pass"], 16) << other;
    EXPECT_EQ(json("b.json")["settings"]["tile"], 64) << other;
  }
}

TEST_F(PhotonPlan, TheImageIsTheSameForAllTilesAndWorkers) {
  ASSERT_EQ(render({"-o", "a.exr"}).exit_code, 0);
  ASSERT_EQ(
      render({"-o", "b.exr", "--tile", "5", "--workers", "5", "--threads", "1", "--verify", "0.2"}).exit_code,
      0);
  EXPECT_TRUE(contents("a.exr") == contents("b.exr"));
  ASSERT_EQ(render({"-o", "p.exr", "--pixel", "7,9"}).exit_code, 0);
}

TEST_F(PhotonPlan, AdaptiveSamplingIsRefused) {
  for (const char* integrator : {"ppm", "photonmapper"}) {
    const ProgramResult result = render({"--integrator", integrator, "--adaptive"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, AllOf(HasSubstr("--adaptive"), HasSubstr("photon mapping")));
  }
  EXPECT_EQ(render({"--target-error", "0.5", "--sampler", "independent"}).exit_code, 0);
}

TEST_F(PhotonPlan, AnEstimateMeasuresItsPasses) {
  for (const Arguments& pass : {Arguments{}, Arguments{"--pass", "16"}}) {
    Arguments arguments{"--estimate", "--json", "--spp", "64"};
    arguments.insert(arguments.end(), pass.begin(), pass.end());
    const ProgramResult result = render(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto plan = nlohmann::json::parse(result.out)["plan"];
    EXPECT_EQ(plan["passes"], pass.empty() ? 64 : 4);
    EXPECT_EQ(plan["tiles"], 1);
  }
}

/// Many units, of maps that are quickly made.
const Arguments kManyMaps{"--spp", "1200", "--set", "integrator.photon_count=5000"};
Arguments by_workers(const std::string& workers) {
  Arguments all{"render",    "s.xml", "--integrator",          "ppm", "--tile", "8", "--workers", workers,
                "--threads", "1",     "--checkpoint-interval", "0.02"};
  all.insert(all.end(), kManyMaps.begin(), kManyMaps.end());
  return all;
}

TEST_F(PhotonPlan, ACheckpointIsOfItsPasses) {
  kill_after(folder_.path(), by_workers("2"), "s.exr.checkpoint", 50ms);
  Arguments other = by_workers("2");
  other.insert(other.end(), {"--pass", "2", "--resume"});
  const ProgramResult refused = run(other);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("samples_per_pass: 1 there, 2 here"));
  const ProgramResult resumed = run(by_workers("2"));
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("going on with s.exr.checkpoint"));
  expect_image_of(kManyMaps);
}

TEST_F(PhotonPlan, TheImageIsTheSameIfWorkersDie) {
  Program program(folder_.path(), by_workers("5"));
  ASSERT_TRUE(comes(folder_ / "s.exr.checkpoint"));
  const std::vector<pid_t> workers = children_of(program.pid());
  ASSERT_EQ(workers.size(), 5u);
  for (const std::size_t worker : {1, 4}) kill(workers[worker], SIGKILL);
  const ProgramResult result = program.wait();
  ASSERT_EQ(result.exit_code, 0);
  const auto known = json("s.json")["workers"];
  auto ended = std::ranges::count_if(known, [](const auto& worker) { return !worker["ended"].is_null(); });
  // On a busy machine, a worker may have been killed before it was connected.
  const std::string early = "a worker ended before it was connected";
  for (auto at = result.err.find(early); at != std::string::npos; at = result.err.find(early, at + 1))
    ++ended;
  EXPECT_GE(ended, 2) << result.err;
  expect_image_of(kManyMaps);
}

TEST_F(PhotonPlan, ATimeBudgetLeavesTheFirstUnits) {
  const Arguments all{"--spp", "1000000", "--tile", "8"};
  Arguments in_time = all, first = all;
  in_time.insert(in_time.end(), {"--workers", "3", "--threads", "1", "--time-budget", "0.3"});
  ASSERT_EQ(render(in_time).exit_code, 0);
  const auto ended = json("s.json");
  EXPECT_EQ(ended["ended_by"], "time_budget");
  EXPECT_GT(ended["samples"]["least_per_pixel"], 0);
  first.insert(first.end(), {"--stop-after-units", std::to_string(ended["units"]["done"].get<int>())});
  ASSERT_EQ(render(first).exit_code, 0);
  EXPECT_EQ(json("s.json")["film_hash"], ended["film_hash"]) << "passes that ran ahead are completed";
}

TEST_F(PhotonPlan, RendersOfAJobFileThatShareASceneHaveMapsOfTheirOwn) {
  write_text(folder_ / "jobs.toml",
             "[[render]]\nscene = 's.xml'\nintegrator = ['ppm', 'path']\nspp = 8\n"
             "[[render]]\nscene = 's.xml'\nintegrator = 'ppm'\nspp = 8\npass = [2, 4]\n");
  const ProgramResult result = run({"render", "jobs.toml", "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto settings = [&](const std::string& name) { return json(name)["settings"]; };
  EXPECT_EQ(settings("s-ppm.json")["samples_per_pass"], 1);
  EXPECT_EQ(settings("s-ppm.json")["tile"], 256);
  EXPECT_EQ(settings("s-path.json")["samples_per_pass"], 16);
  EXPECT_EQ(settings("s-path.json")["tile"], 64);
  EXPECT_EQ(settings("s-2.json")["samples_per_pass"], 2);
  EXPECT_EQ(settings("s-4.json")["samples_per_pass"], 4);
  ASSERT_EQ(render({"--pass", "4", "-o", "a.exr"}).exit_code, 0);
  EXPECT_TRUE(contents("a.exr") == contents("s-4.exr"));
}

}  // namespace
}  // namespace penumbra
