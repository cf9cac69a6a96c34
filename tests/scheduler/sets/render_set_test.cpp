// Tests `penumbra render` with several scenes and with job files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "scheduler/image/image.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/fake_processes.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class RenderSet : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"a.xml", "b.xml", "c.xml"}) write_small_scene(folder_ / name);
  }

  ProgramResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "render");
    return run_penumbra(folder_.path(), arguments);
  }
  std::vector<std::string> states(const std::string& summary = "out/jobs.json") {
    const auto json = nlohmann::json::parse(file_contents(folder_ / summary));
    std::vector<std::string> states;
    for (const auto& job : json["jobs"]) states.push_back(job["state"]);
    return states;
  }
  nlohmann::json job() { return nlohmann::json::parse(file_contents(folder_ / "out/jobs.json"))["jobs"][0]; }
  std::string film_hash(const std::string& name) {
    auto read = read_image(folder_ / name);
    EXPECT_TRUE(read) << read.error().message;
    return read ? std::get<std::string>(read->attribute("penumbra:film_hash").value_or("none")) : "none";
  }

  TemporaryFolder folder_;
};

TEST_F(RenderSet, EachSceneHasTheImageThatItHasAlone) {
  const ProgramResult set =
      run({"a.xml", "b.xml", "c.xml", "-o", "out/", "--workers", "2", "--seed", "3", "-D", "albedo=0.25"});
  EXPECT_EQ(set.exit_code, 0) << set.err;
  EXPECT_THAT(set.out,
              AllOf(HasSubstr("a.xml  done"), HasSubstr("c.xml  done"), HasSubstr("wrote out/jobs.json")));
  EXPECT_THAT(states(), ElementsAre("done", "done", "done"));
  EXPECT_EQ(run({"b.xml", "-o", "alone.exr", "--seed", "3", "-D", "albedo=0.25"}).exit_code, 0);
  EXPECT_NE(film_hash("alone.exr"), "none");
  EXPECT_EQ(film_hash("out/b.exr"), film_hash("alone.exr"));
  for (const char* name : {"out/a.exr", "out/a.png", "out/a.json", "out/c.exr"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / name)) << name;
}

TEST_F(RenderSet, ABadSceneDoesNotStopTheOthersAndTheExitCodeSaysSo) {
  write_text(folder_ / "b.xml", "<scene version='3.0.0'><shape type='sphere'>");
  const ProgramResult set = run({"a.xml", "b.xml", "missing.xml", "c.xml", "-o", "out/"});
  EXPECT_EQ(set.exit_code, 1);
  EXPECT_THAT(states(), ElementsAre("done", "failed", "failed", "done"));
  EXPECT_THAT(set.err, AllOf(HasSubstr("b.xml"), HasSubstr("there is no file 'missing.xml'"),
                             HasSubstr("2 of 4 renders failed or are incomplete")));
  EXPECT_THAT(set.out, HasSubstr("failed"));
}

TEST_F(RenderSet, OneReasonOfManyFailuresIsToldOnce) {
  write_text(
      folder_ / "p.pbrt",
      "Film \"rgb\" \"integer xresolution\" [4] \"integer yresolution\" [4]\nWorldBegin\nNoStatement\n");
  write_text(folder_ / "shots.toml", "[[render]]\nscene = \"p.pbrt\"\nframe = \"1..40\"\nout = \"out/\"\n");
  const ProgramResult set = run({"shots.toml"});
  EXPECT_EQ(set.exit_code, 1);
  const std::string reason = "'NoStatement' is not a directive";
  EXPECT_THAT(set.err, AllOf(HasSubstr(reason),
                             HasSubstr("39 more renders failed like p.pbrt frame=1, from p.pbrt frame=2 to "
                                       "p.pbrt frame=40: "),
                             HasSubstr("40 of 40 renders failed")));
  EXPECT_LT(std::ranges::count(set.err + set.out, '\n'), 10) << set.err << set.out;
  EXPECT_EQ(states("shots.jobs.json").size(), 40u);
  const ProgramResult estimate = run({"shots.toml", "--estimate"});
  EXPECT_EQ(estimate.exit_code, 2);
  EXPECT_THAT(estimate.err, AllOf(HasSubstr(reason), HasSubstr("39 more renders")));
  EXPECT_EQ(estimate.out, "") << "there are no figures";
}

TEST_F(RenderSet, AJobFileHasASummaryOfItsOwnAndATable) {
  write_text(folder_ / "jobs.toml", "[[render]]\nscene = \"a.xml\"\nseed = [1, 2]\nout = \"out/\"\n");
  write_text(folder_ / "night.toml",
             "[[render]]\nscene = \"b.xml\"\ndefine.albedo = 0.25\nout = \"out/\"\n[[render]]\nscene = "
             "\"no.xml\"\n");
  ASSERT_EQ(run({"jobs.toml"}).exit_code, 0);
  const ProgramResult night = run({"night.toml", "--table", "out/results.csv"});
  EXPECT_EQ(night.exit_code, 1);
  EXPECT_THAT(night.out, HasSubstr("wrote night.jobs.json, out/results.csv"));
  EXPECT_THAT(states("jobs.json"), ElementsAre("done", "done"));
  EXPECT_EQ(states("night.jobs.json").size(), 2u);
  const std::string table = file_contents(folder_ / "out/results.csv");
  EXPECT_THAT(table, AllOf(StartsWith("name,scene,albedo,state,samples_per_pixel,seconds,relative_error,file,"
                                      "error\r\nb.xml,b.xml,0.25,done,8,"),
                           HasSubstr("\r\nno.xml,no.xml,,failed,,,,")));
  const ProgramResult same = run({"a.xml", "b.xml", "-o", "out/", "--table", "out/a.exr"});
  EXPECT_EQ(same.exit_code, 2);
  EXPECT_THAT(same.err, HasSubstr("out/a.exr is a file of a.xml and --table"));
}

TEST_F(RenderSet, SummaryAndTableReplaceNoInput) {
  write_text(folder_ / "jobs.toml", "[[render]]\nscene = 'a.xml'\nseed = [1, 2]\n");
  for (const char* option : {"--table", "--summary"})
    for (const char* input : {"jobs.toml", "a.xml", "b.xml"}) {
      const std::string before = file_contents(folder_ / input);
      const ProgramResult refused = run({"jobs.toml", "b.xml", "-o", "none/", option, input});
      EXPECT_EQ(refused.exit_code, 2) << option << " " << input;
      EXPECT_THAT(refused.err, HasSubstr("is an input of this command"));
      EXPECT_EQ(file_contents(folder_ / input), before);
    }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
  const ProgramResult both =
      run({"a.xml", "b.xml", "-o", "out/", "--summary", "/dev/null", "--table", "/dev/null"});
  EXPECT_EQ(both.exit_code, 0) << both.err;
}

TEST_F(RenderSet, ATableThatCannotBeWrittenHidesNoEnd) {
  const ProgramResult set = run({"a.xml", "b.xml", "-o", "out/", "--table", "/dev/full"});
  EXPECT_EQ(set.exit_code, 1);
  EXPECT_THAT(set.err, HasSubstr("/dev/full"));
  EXPECT_THAT(set.out, HasSubstr("wrote out/jobs.json\n"));
}

TEST_F(RenderSet, WhatIsThereUnchangedIsLeftAsItIs) {
  ASSERT_EQ(run({"a.xml", "b.xml", "-o", "out/"}).exit_code, 0);
  const std::string before = file_contents(folder_ / "out/a.json");
  ASSERT_EQ(run({"a.xml", "b.xml", "-o", "out/"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("unchanged", "unchanged"));
  EXPECT_EQ(file_contents(folder_ / "out/a.json"), before) << "its times would differ";
  ASSERT_EQ(run({"a.xml", "b.xml", "-o", "out/"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("unchanged", "unchanged")) << "it stays known";

  // Another seed, a file that is gone, another content of a scene.
  ASSERT_EQ(run({"a.xml", "b.xml", "-o", "out/", "--seed", "9"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("done", "done"));
  std::filesystem::remove(folder_ / "out/a.png");
  ASSERT_EQ(run({"a.xml", "b.xml", "-o", "out/", "--seed", "9"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("done", "unchanged"));
  std::string scene = file_contents(folder_ / "b.xml");
  scene.replace(scene.find("4, 3, 2"), 7, "5, 3, 2");
  write_text(folder_ / "b.xml", scene);
  ASSERT_EQ(run({"a.xml", "b.xml", "-o", "out/", "--seed", "9"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("unchanged", "done"));

  ASSERT_EQ(run({"a.xml", "b.xml", "-o", "out/", "--seed", "9", "--force"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("done", "done"));
}

TEST_F(RenderSet, AnInterruptedRunForgetsNothingOfAnEarlierOne) {
  ASSERT_EQ(run({"a.xml", "b.xml", "c.xml", "-o", "out/"}).exit_code, 0);
  std::string scene = file_contents(folder_ / "a.xml");
  scene.replace(scene.find("\"8\""), 3, "\"4000000\"");
  write_text(folder_ / "a.xml", scene);
  Program set(folder_.path(), {"render", "a.xml", "b.xml", "c.xml", "-o", "out/"});
  std::this_thread::sleep_for(1500ms);
  set.send(SIGINT);
  EXPECT_EQ(set.wait().exit_code, 1);
  write_small_scene(folder_ / "a.xml");
  const ProgramResult other = run({"a.xml", "b.xml", "c.xml", "-o", "out/"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("cannot go on with out/a.exr.checkpoint"));
  EXPECT_THAT(states(), ElementsAre("failed", "unchanged", "unchanged"));
  ASSERT_EQ(run({"a.xml", "b.xml", "c.xml", "-o", "out/", "--restart"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("done", "unchanged", "unchanged"));
}

TEST_F(RenderSet, AShorterTimeBudgetIsAnotherImage) {
  ASSERT_EQ(run({"a.xml", "b.xml", "-o", "out/", "--time-budget", "1000"}).exit_code, 0);
  ASSERT_EQ(run({"a.xml", "b.xml", "-o", "out/"}).exit_code, 0);
  EXPECT_THAT(states(), ElementsAre("done", "done"));
}

/// The first line is there while the second render, which takes long, goes on.
TEST_F(RenderSet, ALineTellsTheEndOfEachRenderAtOnce) {
  Program set(folder_.path(), {"render", "a.xml", "b.xml", "-o", "out/", "--spp", "100000000",
                               "--time-budget", "4", "--workers", "1", "--threads", "1"});
  EXPECT_TRUE(eventually(
      [&] { return file_contents(folder_ / ".stdout").find("1 of 2  a.xml  done") != std::string::npos; },
      60s));
  EXPECT_EQ(file_contents(folder_ / ".stdout").find("2 of 2"), std::string::npos);
  const ProgramResult result = set.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("2 of 2  b.xml  done"), HasSubstr("2 renders: 2 done, in ")));
}

TEST_F(RenderSet, ABudgetThatEndsARenderIsSaidAndRecorded) {
  const ProgramResult first =
      run({"a.xml", "b.xml", "-o", "out/", "--spp", "1000000", "--time-budget", "0.1"});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("ended by the budget, of 1000000 spp"));
  EXPECT_EQ(job()["ended_by"], "time_budget");
  EXPECT_EQ(job()["asked_samples_per_pixel"], 1000000);
  const ProgramResult second =
      run({"a.xml", "b.xml", "-o", "out/", "--spp", "1000000", "--time-budget", "0.1"});
  EXPECT_THAT(second.out, AllOf(HasSubstr("unchanged"), HasSubstr("ended by the budget, of 1000000 spp")));
  const ProgramResult third = run({"a.xml", "b.xml", "-o", "out/", "--spp", "2"});
  EXPECT_THAT(third.out, Not(HasSubstr("budget")));
  EXPECT_FALSE(job().contains("ended_by"));
}

TEST_F(RenderSet, NotesAndAddressesAreSaidOnce) {
  const ProgramResult result = run({"a.xml", "b.xml", "-o", "out/"});
  EXPECT_THAT(result.out, AllOf(HasSubstr("\nnote: sobol"), Not(ContainsRegex("note(.|\n)*note"))));
  EXPECT_THAT(result.err, AllOf(HasSubstr("to watch: "), Not(ContainsRegex("to watch(.|\n)*to watch"))));
  EXPECT_THAT(run({"a.xml", "b.xml", "-o", "out/", "--sampler", "sobol"}).out, Not(HasSubstr("note")));
  EXPECT_THAT(run({"a.xml", "b.xml", "-o", "out/", "--force", "-q"}).out, Not(HasSubstr("note")));
}

TEST_F(RenderSet, ASummaryThatIsNoneIsReplaced) {
  std::filesystem::create_directory(folder_ / "out");
  for (const char* nonsense : {"", "[1]", R"({"format": "penumbra jobs 1", "jobs": [{"scene": 3}]})"}) {
    write_text(folder_ / "out/jobs.json", nonsense);
    ASSERT_EQ(run({"a.xml", "b.xml", "-o", "out/", "--spp", "1"}).exit_code, 0) << nonsense;
    EXPECT_THAT(states(), ElementsAre("done", "done"));
  }
}

TEST_F(RenderSet, NamesHaveFieldsAndCollisionsAreSaidBeforeAnythingStarts) {
  for (const char* name : {"x", "y"}) {
    std::filesystem::create_directory(folder_ / name);
    write_small_scene(folder_ / name / "scene.xml");
  }
  const ProgramResult same = run({"x/scene.xml", "y/scene.xml", "-o", "out/"});
  EXPECT_EQ(same.exit_code, 2);
  EXPECT_THAT(same.err, AllOf(HasSubstr("x/scene.xml and y/scene.xml"), HasSubstr("out/scene.exr"),
                              HasSubstr("{folder}")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  EXPECT_EQ(run({"a.xml", "./a.xml", "-o", "out/"}).exit_code, 2) << "one scene twice";

  const ProgramResult told_apart =
      run({"x/scene.xml", "y/scene.xml", "-o", "out/{folder}-{scene}.exr", "--summary", "all.json"});
  EXPECT_EQ(told_apart.exit_code, 0) << told_apart.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/y-scene.exr"));
  EXPECT_THAT(states("all.json"), ElementsAre("done", "done"));
}

TEST_F(RenderSet, OneFileByTwoNamesIsSaidBeforeAnythingStarts) {
  namespace fs = std::filesystem;
  fs::create_directory(folder_ / "out");
  fs::create_directory(folder_ / "real");
  fs::create_directory_symlink(folder_ / "real", folder_ / "link");
  fs::create_symlink(folder_ / "out/second.exr", folder_ / "out/by-link.exr");  // to a file that is to come
  write_text(folder_ / "out/hard.exr", "before");
  fs::create_hard_link(folder_ / "out/hard.exr", folder_ / "out/same.exr");
  const auto of_two = [&](const std::string& first, const std::string& second, const std::string& more = "") {
    write_text(folder_ / "j.toml", fmt::format("[[render]]\nscene = \"a.xml\"\nout = \"{}\"\n{}\n"
                                               "[[render]]\nscene = \"b.xml\"\nout = \"{}\"\n",
                                               first, more, second));
    return run({"j.toml", "-q"});
  };
  const std::array<std::string, 3> cases[] = {
      {"out/a.exr", "out/a-denoised.exr", "denoise = \"nlmeans\""},
      {"out/a.exr", "out/a-denoised.exr", "set.film.denoise = \"nlmeans\""},
      {"out/x.exr", "./out/../out/x.exr", ""},
      {"real/x.exr", "link/x.exr", ""},
      {"out/second.exr", "out/by-link.exr", ""},
      {"out/hard.exr", "out/same.exr", ""},
  };
  for (const auto& [first, second, more] : cases) {
    const ProgramResult result = of_two(first, second, more);
    EXPECT_EQ(result.exit_code, 2) << second << result.err;
    EXPECT_THAT(result.err, AllOf(HasSubstr("a.xml and b.xml would both be written to"))) << second;
    EXPECT_FALSE(fs::exists(folder_ / "out/a.exr") || fs::exists(folder_ / "jobs.json")) << second;
  }
  EXPECT_EQ(file_contents(folder_ / "out/hard.exr"), "before");
  // Without a denoised image there is no other file of this name.
  const ProgramResult apart = of_two("out/a.exr", "out/a-denoised.exr", "denoise = \"layers\"");
  EXPECT_EQ(apart.exit_code, 0) << apart.err;
}

TEST_F(RenderSet, OptionsThatMeanOneImageAreRefused) {
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"-o", "one.exr"}, "of several images it is a folder"},
      {{"-o", "{camera}.exr"}, "'{camera}' is no field of a name"},
      {{"-o", "{scene"}, "a '{' without its '}'"},
      {{"--pixel", "1,1"}, "--pixel is of one scene"},
      {{"--statistics", "s.json"}, "--statistics FILE is of one scene"},
      {{"-o", "out/", "--summary", "out/a.json"}, "out/a.json is a file of a.xml and the summary"}};
  for (const auto& [options, text] : cases) {
    std::vector<std::string> arguments = {"a.xml", "b.xml"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << text;
    EXPECT_THAT(result.err, HasSubstr(text));
  }
}

TEST_F(RenderSet, AJobFileIsAllItsCombinations) {
  std::filesystem::create_directory(folder_ / "jobs");
  write_text(folder_ / "jobs/all.toml", R"([defaults]
out = "../out/{scene}-{integrator}-{seed:03}.exr"
spp = 4

[[render]]
scene = ["../a.xml", "../b.xml"]
integrator = ["path_ems", "path_mis"]
seed = "1..2"
define.albedo = 0.25

[[render]]
scene = "../c.xml"
define = { albedo = [0.5, 0.75] }
priority = 1
crop = "0,0,8,8"
out = "../out/{albedo}.exr"
)");
  const ProgramResult set = run({"jobs/all.toml", "--workers", "2"});
  ASSERT_EQ(set.exit_code, 0) << set.err;
  // Those of higher priority first, then as they stand.
  const auto json = nlohmann::json::parse(file_contents(folder_ / "jobs/all.jobs.json"));
  std::vector<std::string> names;
  for (const auto& job : json["jobs"]) names.push_back(job["name"]);
  EXPECT_THAT(
      names,
      ElementsAre("jobs/../c.xml albedo=0.5", "jobs/../c.xml albedo=0.75",
                  "jobs/../a.xml integrator=path_ems seed=1", "jobs/../a.xml integrator=path_ems seed=2",
                  "jobs/../a.xml integrator=path_mis seed=1", "jobs/../a.xml integrator=path_mis seed=2",
                  "jobs/../b.xml integrator=path_ems seed=1", "jobs/../b.xml integrator=path_ems seed=2",
                  "jobs/../b.xml integrator=path_mis seed=1", "jobs/../b.xml integrator=path_mis seed=2"));
  EXPECT_EQ(json["jobs"][9]["options"]["integrator"], "path_mis");
  EXPECT_EQ(json["jobs"][9]["options"]["albedo"], "0.25");
  // Each is the image of its own command.
  ASSERT_EQ(run({"b.xml", "-o", "one.exr", "--spp", "4", "--integrator", "path_ems", "--seed", "2", "-D",
                 "albedo=0.25"})
                .exit_code,
            0);
  EXPECT_EQ(film_hash("out/b-path_ems-002.exr"), film_hash("one.exr"));
  EXPECT_NE(film_hash("out/b-path_mis-002.exr"), film_hash("one.exr"));
  EXPECT_EQ(read_image(folder_ / "out/0.75.exr")->data.width, 8);
  // Nothing has changed.
  ASSERT_EQ(run({"jobs/all.toml"}).exit_code, 0);
  EXPECT_THAT(states("jobs/all.jobs.json"), ::testing::Each("unchanged"));
}

TEST_F(RenderSet, RendersThatComeGoOrMoveRenderNoOtherAnew) {
  const auto render = [](const std::string& scene, const std::string& more) {
    return "[[render]]\nscene = \"" + scene + ".xml\"\nout = \"" + scene + "/{scene}.exr\"\n" + more + "\n";
  };
  const auto states_of = [&](const std::string& jobs) {
    write_text(folder_ / "jobs.toml", jobs);
    const ProgramResult set = run({"jobs.toml"});
    EXPECT_EQ(set.exit_code, 0) << set.err;
    return states("jobs.json");
  };
  const std::string first = render("a", "priority = 1"), plain = render("a", ""), second = render("b", ""),
                    third = render("c", "priority = 3");
  EXPECT_THAT(states_of(first + second), ElementsAre("done", "done"));
  EXPECT_THAT(states_of(plain + second), ElementsAre("unchanged", "unchanged"));
  EXPECT_THAT(states_of(second + plain), ElementsAre("unchanged", "unchanged"));
  EXPECT_THAT(states_of(third + first + second), ElementsAre("done", "unchanged", "unchanged"));
  EXPECT_THAT(states_of(second), ElementsAre("unchanged"));
  EXPECT_THAT(states_of(third + first + second), ElementsAre("unchanged", "unchanged", "unchanged"));
  // Another job file of this folder has a summary of its own.
  write_text(folder_ / "other.toml", render("d", ""));
  write_small_scene(folder_ / "d.xml");
  ASSERT_EQ(run({"other.toml"}).exit_code, 0);
  EXPECT_THAT(states("other.jobs.json"), ElementsAre("done"));
  EXPECT_THAT(states_of(first + second), ElementsAre("unchanged", "unchanged"));
}

TEST_F(RenderSet, RendersComeAfterThoseThatMustBeDone) {
  write_text(folder_ / "jobs.toml",
             "[defaults]\nspp = 1\nout = 'out/'\n[[render]]\nscene = 'a.xml'\nafter = ['second', 'first']\n"
             "priority = 9\n[[render]]\nscene = 'b.xml'\nname = 'second'\nafter = 'first'\n"
             "[[render]]\nscene = 'c.xml'\nname = 'first'\nseed = [1, 2]\n");
  const ProgramResult set = run({"jobs.toml"});
  EXPECT_EQ(set.exit_code, 0) << set.err;
  EXPECT_THAT(set.out, ContainsRegex("c.xml seed=1(.|\n)*c.xml seed=2(.|\n)*b.xml(.|\n)*a.xml"));
  write_text(folder_ / "c.xml", "<scene version='3.0.0'><shape type='sphere'>");
  const ProgramResult failed = run({"jobs.toml"});
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_THAT(
      failed.err,
      AllOf(ContainsRegex("b.xml: not begun, because .*c.xml seed=1, after which it comes, is failed"),
            ContainsRegex("a.xml: not begun, because .*b.xml, after which it comes, is failed")));
  EXPECT_THAT(states("jobs.json"), ElementsAre("failed", "failed", "failed", "failed"));
}

TEST_F(RenderSet, AFolderWithItsJobFileAndImagesMayBeMoved) {
  std::filesystem::create_directory(folder_ / "before");
  write_small_scene(folder_ / "before/a.xml");
  write_text(folder_ / "before/jobs.toml",
             "[[render]]\nscene = \"a.xml\"\nseed = [1, 2]\nout = \"out/{seed}.exr\"\n");
  ASSERT_EQ(run({"before/jobs.toml"}).exit_code, 0);
  std::filesystem::rename(folder_ / "before", folder_ / "after");
  ASSERT_EQ(run({"after/jobs.toml"}).exit_code, 0);
  EXPECT_THAT(states("after/jobs.json"), ElementsAre("unchanged", "unchanged"));
}

TEST_F(RenderSet, WhatTheCommandSaysCountsForAllOfAJobFile) {
  write_text(folder_ / "jobs.toml", R"([[render]]
scene = "a.xml"
seed = [1, 2]
spp = [2, 4]
out = "out/{seed}-{spp}.exr"
define.albedo = 0.5
)");
  ASSERT_EQ(run({"jobs.toml", "b.xml", "--spp", "1", "-D", "albedo=0.75", "-o",
                 "here/{scene}-{spp}-{albedo}.exr", "--seed", "7", "--summary", "all.json"})
                .exit_code,
            0);
  EXPECT_THAT(states("all.json"), ElementsAre("done", "done"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "here/a-1-0.75.exr"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "here/b-1-0.75.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  // A folder: named after the scene and what is varied.
  ASSERT_EQ(run({"jobs.toml", "-o", "there/"}).exit_code, 0);
  EXPECT_THAT(states("there/jobs.json"), ElementsAre("done", "done", "done", "done"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "there/a-2-4.exr"));
}

TEST_F(RenderSet, FramesAreVariablesOfScenesOrPartsOfTheirNames) {
  std::string moving = file_contents(folder_ / "a.xml");
  moving.replace(moving.find("value=\"4, 3, 2\""), 15, "value=\"$frame\"");
  write_text(folder_ / "moving.xml", moving);
  write_small_scene(folder_ / "shot.0003.xml");
  write_text(folder_ / "jobs.toml", R"([[render]]
scene = "moving.xml"
frame = "8..12x4"
[[render]]
scene = "shot.{frame:04}.xml"
frame = 3
out = "shot-{frame}.exr"
)");
  ASSERT_EQ(run({"jobs.toml", "--summary", "jobs.json"}).exit_code, 0);
  EXPECT_THAT(states("jobs.json"), ElementsAre("done", "done", "done"));
  ASSERT_EQ(run({"moving.xml", "-D", "frame=12", "-o", "alone.exr"}).exit_code, 0);
  EXPECT_EQ(film_hash("moving.0012.exr"), film_hash("alone.exr"));
  EXPECT_NE(film_hash("moving.0008.exr"), film_hash("alone.exr"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "shot-3.exr"));
}

TEST_F(RenderSet, WrongJobFilesAreBadInputAndNothingIsBegun) {
  const std::pair<const char*, const char*> cases[] = {
      {"scene = 'a.xml'\nseed = [1, 2]\nout = 'out/{scene}.exr'", "tell them apart"},
      {"scene = 'a.xml'\nseed = [1, 2]\nout = 'out/a.exr'", "of several images it is a folder"},
      {"scene = 'a.xml'\nout = 'out/{seed}.exr'", "'{seed}' is no field"},
      {"scene = 'a.xml'\nout = 'out/{scene:03}.exr'", "for a whole number"},
      {"scene = 'a.xml'\nout = 'out/a.tif'", ".exr or .png"},
      {"scene = '{frame}.xml'", "'{frame}' is no field"},
      {"scene = 'a.xml'\nseed = '1..999'\nspp = [1, 2, 3]\nset.film.width = [1, 2, 3, 4]\ndefine.x = [1, 2, "
       "3, 4]\n"
       "tile = [1, 2, 3]",
       "more than 100000 renders"}};
  for (const auto& [text, what] : cases) {
    write_text(folder_ / "jobs.toml", std::string("[[render]]\n") + text);
    const ProgramResult result = run({"jobs.toml"});
    EXPECT_EQ(result.exit_code, 2) << text;
    EXPECT_THAT(result.err, AllOf(HasSubstr("jobs.toml:1:1"), HasSubstr(what)));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }
}

TEST_F(RenderSet, AnImageThatCannotBeWrittenIsTheLossOfItsRenderAlone) {
  std::filesystem::create_directories(folder_ / "out");
  std::filesystem::create_directory(folder_ / "tmp");
  std::filesystem::create_symlink("/dev/full", folder_ / "out/a.png");
  std::filesystem::create_symlink("/dev/full", folder_ / "out/c.exr");
  for (const char* name : {"d.xml", "e.xml"}) write_small_scene(folder_ / name);
  const ProgramResult set =
      run_shell(folder_.path(),
                "TMPDIR=$PWD/tmp penumbra render a.xml b.xml c.xml d.xml e.xml -o out/ --workers 2 2>err; "
                "code=$?; cat err >&2; exit $code");
  EXPECT_EQ(set.exit_code, 1);
  EXPECT_THAT(states(), ElementsAre("failed", "done", "failed", "done", "done"));
  EXPECT_THAT(set.err, AllOf(HasSubstr("a.xml: cannot write "), HasSubstr("c.xml: cannot write "),
                             Not(HasSubstr("b.xml: cannot")), HasSubstr("2 of 5 renders failed")));
  const auto jobs = nlohmann::json::parse(file_contents(folder_ / "out/jobs.json"))["jobs"];
  EXPECT_THAT(jobs[0]["error"].get<std::string>(),
              AllOf(EndsWith("/a.png"), HasSubstr("No space left on device"), HasSubstr("written instead")));
  EXPECT_THAT(jobs[2]["error"].get<std::string>(), EndsWith("/c.exr"));
  for (int ended = 1; ended <= 5; ++ended)
    EXPECT_THAT(set.out,
                ContainsRegex(fmt::format("[0-9]{{2}}:[0-9]{{2}}:[0-9]{{2}}  {} of 5  [a-e].xml  ", ended)));
  EXPECT_THAT(set.out, ContainsRegex("5 renders: 3 done, 2 failed, in [0-9]+ s\n"));
  // Nothing half: what is there is an image, what is not is kept elsewhere.
  for (const char* name : {"b.exr", "d.exr", "e.exr", "a.exr"}) {
    const auto image = read_image(folder_ / "out" / name);
    EXPECT_TRUE(image) << image.error().message;
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out"))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST_F(RenderSet, AFolderThatIsGoneWhileOthersRenderIsTheLossOfItsRendersAlone) {
  std::filesystem::create_directory(folder_ / "tmp");
  for (const char* name : {"x/a.xml", "y/b.xml", "z/c.xml"}) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    write_small_scene(folder_ / name);
  }
  // The middle one's folder becomes a file when the set has begun: the first render takes long enough.
  Program set(folder_.path(), "/bin/bash",
              {"-c", "export TMPDIR=$PWD/tmp; exec " PENUMBRA_BINARY_DIR
                     "/penumbra render x/a.xml y/b.xml z/c.xml -o 'out/{folder}/i.exr' --summary s.json "
                     "-D spp=4000000 --time-budget 1"});
  const auto patience = std::chrono::steady_clock::now() + 60s;
  while (!std::filesystem::exists(folder_ / "out/y") && std::chrono::steady_clock::now() < patience)
    std::this_thread::sleep_for(5ms);
  // Something may be made in it meanwhile: whether it can be written is tried with a file.
  for (std::error_code error; std::filesystem::exists(folder_ / "out/y");)
    std::filesystem::remove_all(folder_ / "out/y", error);
  write_text(folder_ / "out/y", "in the way");
  const ProgramResult result = set.wait();
  EXPECT_EQ(result.exit_code, 1) << result.err;
  const auto jobs = nlohmann::json::parse(file_contents(folder_ / "s.json"))["jobs"];
  EXPECT_EQ(jobs[0]["state"], "done") << result.err;
  EXPECT_EQ(jobs[1]["state"], "failed");
  EXPECT_EQ(jobs[2]["state"], "done");
  EXPECT_THAT(jobs[1]["error"].get<std::string>(), HasSubstr("out/y"));
  EXPECT_TRUE(read_image(folder_ / "out/x/i.exr") && read_image(folder_ / "out/z/i.exr"));
}

TEST_F(RenderSet, CtrlCKeepsWhatIsDoneAndSaysWhatIsNot) {
  Program set(folder_.path(), {"render", "a.xml", "b.xml", "c.xml", "-o", "out/", "-D", "spp=4000000"});
  std::this_thread::sleep_for(2s);
  set.send(SIGINT);
  const ProgramResult result = set.wait();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(states(), ElementsAre("incomplete", "not begun", "not begun"));
  EXPECT_THAT(result.err, AllOf(HasSubstr("1 of 3 renders failed or are incomplete"),
                                HasSubstr("2 of 3 renders not begun: a signal stopped the set")));
  EXPECT_THAT(result.out, HasSubstr("3 renders: 1 incomplete, 2 not begun"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/a.exr"));
}

}  // namespace
}  // namespace penumbra
