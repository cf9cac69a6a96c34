// `penumbra render --estimate` with several scenes and with job files. The renders are so small that their
// measurements end at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class SetEstimate : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"a.xml", "b.xml"}) write_small_scene(folder_ / name);
  }
  [[nodiscard]] ProgramResult run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"render", "--estimate"});
    return run_penumbra(folder_.path(), arguments);
  }
  [[nodiscard]] nlohmann::json json_of(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(result.out);
  }

  TemporaryFolder folder_;
};

constexpr const char* kJobs = R"([[render]]
scene = "a.xml"
spp = [8, 16]
[[render]]
scene = "b.xml"
spp = 32
integrator = "ao"
out = "b.png"
set.film.height = 40
)";

TEST_F(SetEstimate, TotalsAreTheSumsAndMaximaOfRendersThatDiffer) {
  write_text(folder_ / "jobs.toml", kJobs);
  const auto json = json_of({"jobs.toml", "--set", "film.width=12", "--workers", "2"});
  EXPECT_THAT(folder_.names(), ElementsAre("a.xml", "b.xml", "jobs.toml")) << "no image and no summary";
  const auto &renders = json["renders"], &totals = json["totals"];
  ASSERT_EQ(renders.size(), 3u);
  constexpr int kSamples[] = {12 * 20 * 8, 12 * 20 * 16, 12 * 40 * 32};
  double samples = 0, core_seconds = 0;
  std::uint64_t units = 0, results = 0, images = 0, worker = 0, scheduler = 0;
  std::vector<double> wall(totals["wall"].size());
  for (std::size_t i = 0; i < renders.size(); ++i) {
    const auto &plan = renders[i]["plan"], &estimate = renders[i]["estimate"];
    EXPECT_EQ(plan["samples"], kSamples[i]);
    samples += estimate["samples"].get<double>();
    core_seconds += estimate["core_seconds"].get<double>();
    units += plan["units"].get<std::uint64_t>();
    results += plan["result_bytes"].get<std::uint64_t>();
    images += plan["image_bytes"].get<std::uint64_t>();
    scheduler = std::max(scheduler, plan["scheduler_memory_bytes"].get<std::uint64_t>());
    worker = std::max(worker, renders[i]["measured"]["worker_memory_bytes"].get<std::uint64_t>());
    ASSERT_EQ(estimate["wall"].size(), wall.size());
    for (std::size_t j = 0; j < wall.size(); ++j) {
      EXPECT_EQ(estimate["wall"][j]["workers"], totals["wall"][j]["workers"]);
      wall[j] += estimate["wall"][j]["seconds"].get<double>();
    }
  }
  EXPECT_EQ(totals["renders"], 3);
  EXPECT_DOUBLE_EQ(totals["samples"], samples);
  EXPECT_DOUBLE_EQ(totals["samples"], kSamples[0] + kSamples[1] + kSamples[2]);
  EXPECT_DOUBLE_EQ(totals["core_seconds"], core_seconds);
  EXPECT_EQ(totals["units"], units);
  EXPECT_EQ(totals["result_bytes"], results);
  EXPECT_EQ(totals["image_bytes"], images);
  EXPECT_EQ(renders[2]["plan"]["image_bytes"], 0) << "a PNG alone";
  EXPECT_EQ(totals["worker_memory_bytes"], worker);
  EXPECT_EQ(totals["scheduler_memory_bytes"], scheduler);
  EXPECT_EQ(renders[1]["options"]["spp"], "16");
  EXPECT_EQ(wall.size(), 5u) << "1, 2, 8, 32, 128";
  for (std::size_t j = 0; j < wall.size(); ++j) EXPECT_DOUBLE_EQ(totals["wall"][j]["seconds"], wall[j]);
}

TEST_F(SetEstimate, EachRenderIsPlannedAsByItself) {
  const auto set = json_of({"a.xml", "b.xml", "-o", "out/", "--spp", "16", "--tile", "8", "--pass", "4"});
  const auto alone = json_of({"b.xml", "--spp", "16", "--tile", "8", "--pass", "4"});
  EXPECT_EQ(set["renders"][1]["plan"], alone["plan"]);
  EXPECT_EQ(set["renders"][1]["scene"], alone["scene"]);
}

TEST_F(SetEstimate, SeedsAreMeasuredOnceAndShareTheirScene) {
  write_text(folder_ / "jobs.toml", "[[render]]\nscene = \"a.xml\"\nseed = \"1..3\"\n");
  const auto json = json_of({"jobs.toml"});
  const auto& renders = json["renders"];
  ASSERT_EQ(renders.size(), 3u);
  EXPECT_EQ(renders[0]["measured"], renders[2]["measured"]);
  EXPECT_EQ(renders[0]["estimate"], renders[1]["estimate"]);
  const auto scene = renders[0]["plan"]["scene_bytes"].get<std::uint64_t>();
  EXPECT_LT(json["totals"]["scene_bytes"], scene + 2000) << "only headers differ";
}

TEST_F(SetEstimate, ATableHasARowForEachRender) {
  const ProgramResult result = run({"a.xml", "b.xml", "-o", "out/"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("core-hours"), HasSubstr("\na.xml "), HasSubstr("\nb.xml "),
                                HasSubstr("Total of 2 renders"), HasSubstr("with 128 workers")));
}

TEST_F(SetEstimate, ABadSceneIsNamedAndDoesNotStopTheOthers) {
  write_text(folder_ / "bad.xml", "<scene version='3.0.0'><shape type='sphere'>");
  const ProgramResult result = run({"bad.xml", "missing.xml", "b.xml", "-o", "out/"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("bad.xml:"), HasSubstr("there is no file 'missing.xml'")));
  EXPECT_THAT(result.out, HasSubstr("Total of 1 of 3 renders"));
  const ProgramResult as_json = run({"bad.xml", "b.xml", "-o", "out/", "--json"});
  EXPECT_EQ(as_json.exit_code, 2);
  const auto json = nlohmann::json::parse(as_json.out);
  EXPECT_EQ(json["totals"]["renders"], 1);
  EXPECT_TRUE(json["renders"][0].contains("error"));
  EXPECT_FALSE(json["renders"][0].contains("estimate"));

  write_text(folder_ / "jobs.toml", "[[render]]\nscene = \"a.xml\"\nsp = 4\n");
  const ProgramResult job = run({"jobs.toml"});
  EXPECT_EQ(job.exit_code, 2);
  EXPECT_THAT(job.err, HasSubstr("jobs.toml:3:1: error: a render has no 'sp'"));
}

}  // namespace
}  // namespace penumbra
