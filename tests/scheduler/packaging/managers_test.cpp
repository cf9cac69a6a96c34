// The templates for managers of render farms in scheduler/packaging/managers, run as those run them: that of
// Open Job Description by its own program, that of Flamenco by a stand-in of its manager.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "scheduler/files/quoting.h"
#include "tests/scheduler/cli/moving_scene.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::managers_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class Managers : public ::testing::Test {
 protected:
  void SetUp() override { write_moving_scene(folder_ / "s.xml"); }
  [[nodiscard]] bool has(const std::string& program) const {
    return run_shell(folder_.path(), "command -v " + program).exit_code == 0;
  }
  [[nodiscard]] bool is_there(const std::string& name) const {
    return std::filesystem::exists(folder_ / name);
  }
  ProgramResult openjd(const std::string& frames) const {
    return run_shell(folder_.path(),
                     "openjd run " + shell_quoted(source_path("scheduler/packaging/managers/openjd.yaml")) +
                         " -p Scene=s.xml -p Out='out/a b.####.exr' -p ChunkSize=2 -p 'Options=--spp 4 "
                         "--threads 1' -p Frames=" +
                         frames);
  }

  TemporaryFolder folder_;
};

TEST_F(Managers, OpenJobDescriptionRendersChunksAndTellsProgress) {
  if (!has("openjd")) GTEST_SKIP() << "there is no openjd (pip install openjd-cli)";
  const ProgramResult done = openjd("1-3,7-9:2");
  ASSERT_EQ(done.exit_code, 0) << done.out << done.err;
  for (const char* name : {"1", "2", "3", "7", "9"})
    EXPECT_TRUE(is_there(std::string("out/a b.000") + name + ".exr")) << name;
  EXPECT_FALSE(is_there("out/a b.0008.exr"));
  EXPECT_THAT(done.out, AllOf(HasSubstr("openjd_progress: 50\n"), HasSubstr("openjd_progress: 100\n"),
                              Not(HasSubstr("openjd_fail"))));
  // Only what is missing is rendered again.
  std::filesystem::remove(folder_ / "out/a b.0002.exr");
  const ProgramResult again = openjd("1-3,7-9:2");
  ASSERT_EQ(again.exit_code, 0) << again.out;
  EXPECT_THAT(again.out, AllOf(HasSubstr("frame=1  unchanged"), HasSubstr("frame=2  done")));
  std::filesystem::remove(folder_ / "s.xml");
  const ProgramResult failed = openjd("1-3");
  EXPECT_NE(failed.exit_code, 0);
  EXPECT_THAT(failed.out, HasSubstr("openjd_fail: frames failed"));
}

TEST_F(Managers, FlamencosTasksRenderTheirFrames) {
  if (!has("node")) GTEST_SKIP() << "there is no node";
  const std::string settings =
      R"({"scene": "s.xml", "frames": "1-3,7", "chunk_size": 2, "output": "out/a b.####.exr",
          "options": "--spp 4  --threads 1"})";
  const ProgramResult compiled = run_shell(
      folder_.path(), "node " + shell_quoted(source_path("tests/scheduler/packaging/flamenco_stub.js")) +
                          " " + shell_quoted(source_path("scheduler/packaging/managers/penumbra-frames.js")) +
                          " " + shell_quoted(settings));
  ASSERT_EQ(compiled.exit_code, 0) << compiled.err;
  const auto tasks = nlohmann::json::parse(compiled.out);
  ASSERT_EQ(tasks.size(), 2u);
  EXPECT_EQ(tasks[1]["name"], "frames 3,7");
  for (const auto& task : tasks)
    for (const auto& command : task["commands"]) {
      EXPECT_EQ(command["name"], "exec");
      std::string line = command["parameters"]["exe"];
      for (const std::string word : command["parameters"]["args"]) line += " " + shell_quoted(word);
      const ProgramResult ran = run_shell(folder_.path(), line);
      EXPECT_EQ(ran.exit_code, 0) << ran.err;
    }
  for (const char* name : {"1", "2", "3", "7"})
    EXPECT_TRUE(is_there(std::string("out/a b.000") + name + ".exr")) << name;
}

}  // namespace
}  // namespace penumbra::managers_test
