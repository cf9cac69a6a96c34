// `penumbra render --resume` after each kind of event that ends a render early.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "tests/scheduler/cli/killed_render.h"
#include "tests/scheduler/cli/small_scene.h"
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

/// With more options; one that is there gets another value.
Arguments operator+(Arguments all, const Arguments& more) {
  for (std::size_t i = 0; i < more.size(); ++i) {
    const auto there = std::ranges::find(all, more[i]);
    if (there == all.end() || !more[i].starts_with("--"))
      all.push_back(more[i]);
    else
      *std::next(there) = more[++i];
  }
  return all;
}

class Resume : public ::testing::Test {
 protected:
  void SetUp() override { write_small_scene(folder_ / "s.xml"); }

  ProgramResult run(const Arguments& arguments) const { return run_penumbra(folder_.path(), arguments); }
  [[nodiscard]] bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
  [[nodiscard]] nlohmann::json statistics(const std::string& name) const {
    return nlohmann::json::parse(file_contents(folder_ / name));
  }
  [[nodiscard]] bool comes(const std::string& checkpoint) const {
    return penumbra::comes(folder_ / checkpoint);
  }
  void kill_after(const Arguments& arguments, const std::string& checkpoint,
                  std::chrono::milliseconds after) const {
    penumbra::kill_after(folder_.path(), arguments, checkpoint, after);
  }

  TemporaryFolder folder_;
};

/// Nine tiles and many passes, for a second or two.
const Arguments kRender = Arguments{"render", "s.xml", "--spp", "60000"} + kManyUnits;

struct Kind {
  const char* name;
  Arguments options;
};
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

class ResumeKinds : public Resume, public ::testing::WithParamInterface<Kind> {};

TEST_P(ResumeKinds, KilledAgainAndAgainItComesToTheSameBytes) {
  const Arguments render = kRender + GetParam().options;
  const ProgramResult undisturbed = run(render + Arguments{"-o", "a.exr"});
  ASSERT_EQ(undisturbed.exit_code, 0) << undisturbed.err;
  EXPECT_FALSE(exists("a.exr.checkpoint")) << "a render that is complete leaves none";
  std::mt19937 random(7);
  const Arguments again = render + Arguments{"-o", "b.exr", "--resume"};
  int killed = 0;
  for (; killed < 4; ++killed) {
    Program program(folder_.path(), again);
    std::this_thread::sleep_for(std::chrono::milliseconds(150 + random() % 500));
    program.send(SIGKILL);
    program.wait();
    if (exists("b.exr")) break;
  }
  if (!exists("b.exr")) {
    const bool has_checkpoint = exists("b.exr.checkpoint");
    EXPECT_TRUE(has_checkpoint);
    const ProgramResult resumed = run(again);
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    EXPECT_THAT(resumed.err, HasSubstr("going on with b.exr.checkpoint"));
    const auto of_resumed = statistics("b.json"), of_undisturbed = statistics("a.json");
    EXPECT_GT(of_resumed["samples"]["before"], 0);
    EXPECT_EQ(of_undisturbed["samples"]["before"], 0);
    EXPECT_GT(of_resumed["seconds"]["before"], 0.0);
    EXPECT_EQ(of_resumed["units"]["done"], of_undisturbed["units"]["done"]);
    EXPECT_EQ(of_resumed["samples"]["total"], of_undisturbed["samples"]["total"]);
  }
  EXPECT_GE(killed, 2) << "it was over before it could be killed";
  EXPECT_TRUE(file_contents(folder_ / "a.exr") == file_contents(folder_ / "b.exr"));
  EXPECT_FALSE(exists("b.exr.checkpoint"));
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, ResumeKinds,
    ::testing::Values(
        Kind{"path", {}},
        Kind{"crop_and_first_samples", {"--crop", "2,3,21,18", "--spp", "100000", "--stop-after", "90000"}},
        Kind{"stratified", {"--sampler", "stratified", "--seed", "5"}},
        Kind{"target_error", {"--sampler", "independent", "--target-error", "0.0015", "--spp", "200000"}},
        Kind{"adaptive", {"--adaptive", "--sampler", "sobol"}},
        Kind{"without_layers", {"--no-features", "--integrator", "path_ems"}},
        Kind{"embree", {"--intersector", "embree"}}),
    [](const auto& parameter) { return parameter.param.name; });

TEST_F(Resume, AfterCtrlCItGoesOnFromTheEnd) {
  const Arguments render = kRender + Arguments{"--checkpoint-interval", "3600"};
  {
    Program program(folder_.path(), render);
    std::this_thread::sleep_for(700ms);
    program.send(SIGINT);
    const ProgramResult result = program.wait();
    ASSERT_EQ(result.exit_code, 1) << result.err;
  }
  const auto interrupted = statistics("s.json");
  ASSERT_GT(interrupted["samples"]["total"], 0);
  ASSERT_TRUE(exists("s.exr.checkpoint"));
  const ProgramResult resumed = run(render + Arguments{"--resume"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(statistics("s.json")["samples"]["before"], interrupted["samples"]["total"])
      << "nothing of what the image had is lost";
  ASSERT_EQ(run(kRender + Arguments{"-o", "a.exr"}).exit_code, 0);
  EXPECT_TRUE(file_contents(folder_ / "a.exr") == file_contents(folder_ / "s.exr"));
}

TEST_F(Resume, WithoutACheckpointItBeginsAndSaysSo) {
  const ProgramResult result = run({"render", "s.xml", "--resume"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("there is no s.exr.checkpoint: the render starts at the beginning"));
  EXPECT_THAT(folder_.names(), ElementsAre("s.exr", "s.json", "s.png", "s.xml"));
}

TEST_F(Resume, AnotherRenderIsRefusedWithWhatDiffers) {
  kill_after(kRender, "s.exr.checkpoint", 100ms);
  const std::string before = file_contents(folder_ / "s.exr.checkpoint");
  const auto refused = [&](const Arguments& options, const std::string& why) {
    for (const Arguments& more : {Arguments{"--resume"}, Arguments{}}) {
      const ProgramResult result = run(kRender + options + more);
      EXPECT_EQ(result.exit_code, 2) << why;
      EXPECT_THAT(result.err, AllOf(HasSubstr("cannot go on with s.exr.checkpoint"), HasSubstr(why),
                                    HasSubstr("with --restart the render begins anew")));
      EXPECT_TRUE(file_contents(folder_ / "s.exr.checkpoint") == before) << why;
      EXPECT_FALSE(exists("s.exr"));
    }
  };
  refused({"--seed", "4"}, "seed: 0 there, 4 here");
  refused({"--spp", "16"}, "spp: 60000 there, 16 here");
  refused({"--pass", "8"}, "samples_per_pass: 32 there, 8 here");
  refused({"--tile", "16"}, "tile: 8 there, 16 here");
  refused({"--crop", "0,0,8,8"}, "crop: 0,0,24,20 there, 0,0,8,8 here");
  refused({"-D", "albedo=0.25"}, "defines: none there, albedo=0.25 here");
  refused({"--integrator", "path_ems"}, "integrator");
  refused({"--intersector", "embree"}, "intersector: portable there, embree here");
  std::string scene = file_contents(folder_ / "s.xml");
  const std::string as_it_was = scene;
  scene.replace(scene.find("4, 3, 2"), 7, "5, 3, 2");
  write_text(folder_ / "s.xml", scene);
  refused({}, "content of the scene file");
  write_text(folder_ / "s.xml", as_it_was);
  // Other workers are none of its business; and it goes on by itself.
  const ProgramResult resumed = run(kRender + Arguments{"--workers", "1", "--threads", "2"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("going on with s.exr.checkpoint"));
}

TEST_F(Resume, ADamagedCheckpointIsRefusedAndStays) {
  kill_after(kRender, "s.exr.checkpoint", 100ms);
  const std::string whole = file_contents(folder_ / "s.exr.checkpoint");
  std::mt19937 random(11);
  for (int i = 0; i < 6; ++i) {
    std::string damaged = whole;
    if (i % 2 == 0)
      damaged.resize(random() % damaged.size());
    else
      damaged[random() % damaged.size()] ^= char(1 << random() % 7);
    write_text(folder_ / "s.exr.checkpoint", damaged);
    const ProgramResult result = run(kRender + Arguments{"--resume"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("cannot go on with s.exr.checkpoint: it "));
    EXPECT_TRUE(file_contents(folder_ / "s.exr.checkpoint") == damaged);
  }
  EXPECT_EQ(run(kRender + Arguments{"--resume", "--restart"}).exit_code, 2);
  const ProgramResult anew = run(kRender + Arguments{"--spp", "64", "--restart"});
  EXPECT_EQ(anew.exit_code, 0);
  EXPECT_THAT(anew.err, Not(HasSubstr("going on")));
  EXPECT_FALSE(exists("s.exr.checkpoint"));
}

TEST_F(Resume, ASceneThatVanishesOrChangesInMidRunDoesNotMatter) {
  ASSERT_EQ(run(kRender + Arguments{"-o", "a.exr"}).exit_code, 0);
  for (const bool vanishes : {true, false}) {
    write_small_scene(folder_ / "s.xml");
    Program program(folder_.path(), kRender + Arguments{"-o", "b.exr"});
    ASSERT_TRUE(comes("b.exr.checkpoint"));
    std::filesystem::remove(folder_ / "s.xml");
    if (!vanishes) write_text(folder_ / "s.xml", "<scene");
    const ProgramResult result = program.wait();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(file_contents(folder_ / "a.exr") == file_contents(folder_ / "b.exr"));
    std::filesystem::remove(folder_ / "b.exr");
  }
}

TEST_F(Resume, AFolderThatVanishesOrIsFullIsAWarning) {
  Program program(folder_.path(), kRender + Arguments{"-o", "out/a.exr"});
  ASSERT_TRUE(comes("out/a.exr.checkpoint"));
  std::filesystem::rename(folder_ / "out", folder_ / "elsewhere");
  std::this_thread::sleep_for(300ms);
  std::filesystem::rename(folder_ / "elsewhere", folder_ / "out");
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err,
              HasSubstr("no checkpoint is kept, so this render could not be resumed: cannot write"));

  const ProgramResult limited = run_shell(
      folder_.path(),
      "ulimit -f 16; export TMPDIR=$PWD; penumbra render s.xml -o b.exr --spp 60000 --pass 32 --tile 8 "
      "--checkpoint-interval 0.02 --no-features");
  EXPECT_THAT(limited.err, HasSubstr("File too large"));
  EXPECT_FALSE(exists("b.exr.checkpoint"));
}

TEST_F(Resume, ATimeBudgetCountsWhatWasSpentBefore) {
  const Arguments render = {
      "render", "s.xml", "--spp", "1000000000", "--pass", "32", "--time-budget", "3", "--checkpoint-interval",
      "0.05"};
  kill_after(render, "s.exr.checkpoint", 1500ms);
  const auto begin = std::chrono::steady_clock::now();
  const ProgramResult resumed = run(render + Arguments{"--resume"});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  const auto json = statistics("s.json");
  const double before = json["seconds"]["before"], rendered = json["seconds"]["render"];
  EXPECT_GT(before, 1.0);
  // From the start of the workers; what is started and ended beside that takes less than a second.
  EXPECT_GT(before + rendered, 3.0);
  EXPECT_LT(before + rendered, 4.5) << "all in all " << taken.count() << " s";
}

TEST_F(Resume, ASetGoesOnWithEachOfItsRenders) {
  for (const char* name : {"a.xml", "b.xml", "c.xml"}) write_small_scene(folder_ / name);
  const Arguments set = {"render",    "a.xml",  "b.xml",     "c.xml",  "--spp",
                         "30000",     "--pass", "32",        "--tile", "8",
                         "--workers", "2",      "--threads", "1",      "--checkpoint-interval",
                         "0.02"};
  ASSERT_EQ(run(set + Arguments{"-o", "whole/"}).exit_code, 0);
  kill_after(set + Arguments{"-o", "out/"}, "out/b.exr.checkpoint", 50ms);
  const ProgramResult resumed = run(set + Arguments{"-o", "out/", "--resume"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err,
              AllOf(HasSubstr("going on with out/b.exr.checkpoint"), Not(HasSubstr("there is no"))));
  for (const char* name : {"a.exr", "b.exr", "c.exr"}) {
    EXPECT_TRUE(file_contents(folder_ / "whole" / name) == file_contents(folder_ / "out" / name)) << name;
    EXPECT_FALSE(exists("out/" + std::string(name) + ".checkpoint"));
  }
  // A stale one fails its render alone; with --restart it is replaced.
  write_text(folder_ / "out/b.exr.checkpoint", "stale");
  const Arguments other = set + Arguments{"-o", "out/", "--spp", "64"};
  const ProgramResult stale = run(other);
  EXPECT_EQ(stale.exit_code, 1);
  EXPECT_THAT(stale.err,
              AllOf(HasSubstr("b.xml: cannot go on with out/b.exr.checkpoint"), HasSubstr("1 of 3")));
  EXPECT_EQ(run(other + Arguments{"--restart"}).exit_code, 0);
  EXPECT_FALSE(exists("out/b.exr.checkpoint"));
}

TEST_F(Resume, OfOnePixelThereIsNothingToResume) {
  EXPECT_EQ(run({"render", "s.xml", "--pixel", "1,1", "--resume"}).exit_code, 2);
  EXPECT_EQ(run({"render", "s.xml", "--pixel", "1,1"}).exit_code, 0);
  EXPECT_THAT(folder_.names(), ElementsAre("s.xml"));
}

TEST_F(Resume, NoneAreKeptWhereNoneAreWanted) {
  {
    Program program(folder_.path(), kRender + Arguments{"--checkpoint-interval", "0", "--spp", "1000000000"});
    std::this_thread::sleep_for(900ms);
    EXPECT_FALSE(exists("s.exr.checkpoint"));
    program.send(SIGINT);
    EXPECT_EQ(program.wait().exit_code, 1);
  }
  EXPECT_FALSE(exists("s.exr.checkpoint"));
}

}  // namespace
}  // namespace penumbra
