// `penumbra advise` and `--integrator auto` as users run them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/scheduler/advise/caustic_scene.h"
#include "tests/scheduler/cli/killed_render.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

using Arguments = std::vector<std::string>;

class AdviseCommand : public ::testing::Test {
 protected:
  void SetUp() override { write_caustic_scene(folder_ / "c.xml"); }
  ProgramResult run(const Arguments& arguments) const { return run_penumbra(folder_.path(), arguments); }
  ProgramResult render(const std::string& name, const Arguments& more) const {
    Arguments arguments{"render", "c.xml", "--integrator", "auto", "--spp", "2", "-o", name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramResult rendered = run(arguments);
    EXPECT_EQ(rendered.exit_code, 0) << rendered.err;
    return rendered;
  }
  nlohmann::json statistics(const std::string& name) const {
    return nlohmann::json::parse(file_contents(folder_ / name));
  }
  TemporaryFolder folder_;
};

TEST_F(AdviseCommand, PrintsATableAndOptionsThatWork) {
  const ProgramResult advised = run({"advise", "c.xml"});
  ASSERT_EQ(advised.exit_code, 0) << advised.err;
  EXPECT_THAT(advised.out, AllOf(HasSubstr("to equal error"), HasSubstr("path_mis"), HasSubstr("auto: ppm")));
  const std::string before = "Options for ";
  const std::size_t options = advised.out.rfind(before + "penumbra render: ");
  ASSERT_NE(options, std::string::npos);
  std::string line = advised.out.substr(options + before.size());
  line.pop_back();
  line.replace(line.find(':'), 1, " c.xml");
  const ProgramResult rendered = run_shell(folder_.path(), line + " --spp 2 -q -o a.exr");
  EXPECT_EQ(rendered.exit_code, 0) << line << "\n" << rendered.err;
  // `--integrator auto` takes the same.
  const ProgramResult chosen = render("b.exr", {});
  EXPECT_THAT(chosen.err, HasSubstr("auto: ppm"));
  EXPECT_EQ(statistics("b.json").at("film_hash"), statistics("a.json").at("film_hash"));
}

TEST_F(AdviseCommand, JsonHasAllCandidates) {
  const ProgramResult advised = run({"advise", "c.xml", "--json"});
  ASSERT_EQ(advised.exit_code, 0) << advised.err;
  const auto json = nlohmann::json::parse(advised.out);
  EXPECT_GE(json.at("candidates").size(), 2u);
  EXPECT_THAT(json.at("chosen").get<std::string>(), StartsWith("ppm"));
  EXPECT_THAT(json.at("options").get<std::string>(),
              StartsWith("--integrator ppm --set integrator.caustics_only=true"));
}

TEST_F(AdviseCommand, TheRecordHasTheChoiceAndRepeatsTheImage) {
  render("a.exr", {});
  const auto record = statistics("a.json");
  EXPECT_EQ(record.at("settings").at("integrator"), "ppm");
  EXPECT_EQ(record.at("settings").at("integrator.caustics_only"), "true");
  EXPECT_THAT(record.at("auto").get<std::string>(), StartsWith("auto: ppm"));
  const std::string command = record.at("repeat_command");
  EXPECT_THAT(command, AllOf(HasSubstr("--integrator ppm"), Not(HasSubstr("auto"))));
  EXPECT_EQ(run_shell(folder_.path(), command + " -q -o b.exr").exit_code, 0);
  EXPECT_EQ(file_contents(folder_ / "a.exr"), file_contents(folder_ / "b.exr"));
}

TEST_F(AdviseCommand, WorkersAndThreadsMakeNoDifference) {
  render("a.exr", {"--workers", "1", "--threads", "1"});
  render("b.exr", {"--workers", "2", "--threads", "2"});
  EXPECT_EQ(file_contents(folder_ / "a.exr"), file_contents(folder_ / "b.exr"));
  EXPECT_EQ(statistics("a.json").at("auto"), statistics("b.json").at("auto"));
}

TEST_F(AdviseCommand, JobFilesAskForIt) {
  write_small_scene(folder_ / "s.xml");
  write_text(folder_ / "jobs.toml",
             "[[render]]\nscene = [\"c.xml\", \"s.xml\"]\nintegrator = \"auto\"\nspp = 2\nseed = \"1..2\"\n");
  const ProgramResult rendered = run({"render", "jobs.toml"});
  ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  EXPECT_THAT(rendered.err,
              AllOf(HasSubstr("c.xml seed=1: auto: ppm"), HasSubstr("s.xml seed=1: auto: path")));
  for (const char* seed : {"1", "2"})
    EXPECT_EQ(statistics(std::string("c-") + seed + ".json").at("settings").at("integrator"), "ppm");
}

TEST_F(AdviseCommand, FramesOfAShotAreAlike) {
  const ProgramResult rendered =
      run({"render", "c.xml", "--integrator", "auto", "--spp", "1", "--frames", "1-2", "-o", "f.####.exr"});
  ASSERT_EQ(rendered.exit_code, 0) << rendered.err;
  EXPECT_EQ(statistics("f.0001.json").at("auto"), statistics("f.0002.json").at("auto"));
}

TEST_F(AdviseCommand, AContinuedRenderKeepsTheChoice) {
  const Arguments all{"render", "c.xml", "--integrator", "auto", "--spp", "100"};
  const auto with = [](Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  ASSERT_EQ(run(with(all, {"-o", "a.exr"})).exit_code, 0);
  const Arguments again = with(all, {"-o", "b.exr", "--checkpoint-interval", "0.02"});
  kill_after(folder_.path(), again, "b.exr.checkpoint", 0ms);
  ASSERT_TRUE(std::filesystem::exists(folder_ / "b.exr.checkpoint"));
  const ProgramResult continued = run(with(again, {"--resume"}));
  ASSERT_EQ(continued.exit_code, 0) << continued.err;
  EXPECT_THAT(continued.err, HasSubstr("going on with"));
  EXPECT_EQ(file_contents(folder_ / "a.exr"), file_contents(folder_ / "b.exr"));
}

TEST_F(AdviseCommand, BadInputSaysWhatIsWrong) {
  write_text(folder_ / "dark.xml",
             R"(<scene version="3.0.0"><sensor type="perspective"/><shape type="sphere"/></scene>)");
  const ProgramResult dark = run({"render", "dark.xml", "--integrator", "auto", "-o", "d.exr"});
  EXPECT_EQ(dark.exit_code, 2);
  EXPECT_THAT(dark.err, AllOf(HasSubstr("dark.xml"), HasSubstr("--integrator auto"), HasSubstr("no light")));
  EXPECT_EQ(run({"advise", "none.xml"}).exit_code, 2);
}

}  // namespace
}  // namespace penumbra
