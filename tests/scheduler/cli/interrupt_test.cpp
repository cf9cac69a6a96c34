// Tests Ctrl-C (SIGINT) during a render.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <thread>
#include <vector>

#include "scheduler/image/image.h"
#include "tests/scheduler/cli/small_scene.h"
#include "tests/support/fake_processes.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kPatience = std::chrono::seconds(60);

bool is_alive(pid_t pid) {
  const char state = process_state(pid);
  return state != 0 && state != 'Z';
}

/// A render that would take for ever, with two workers that are at work.
class Interrupt : public ::testing::Test {
 protected:
  void SetUp() override {
    write_small_scene(folder_ / "s.xml");
    program_.emplace(folder_.path(),
                     std::vector<std::string>{"render", "s.xml", "--spp", "1000000000", "--pass", "64",
                                              "--workers", "2", "--threads", "1"});
    ASSERT_TRUE(eventually([&] { return (workers_ = children_of(program_->pid())).size() == 2; }, kPatience));
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
  void expect_no_orphans() {
    for (const pid_t worker : workers_) {
      EXPECT_TRUE(eventually([&] { return !is_alive(worker); }, kPatience))
          << "worker " << worker << " lives on";
    }
  }
  TemporaryFolder folder_;
  std::optional<Program> program_;
  std::vector<pid_t> workers_;
};

TEST_F(Interrupt, KeepsWhatIsMergedAndSaysThatItIsIncomplete) {
  program_->send_to_group(SIGINT);
  const ProgramResult result = program_->wait();
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("incomplete"));
  expect_no_orphans();
  EXPECT_THAT(folder_.names(), ElementsAre("s.exr", "s.exr.checkpoint", "s.json", "s.png", "s.xml"));
  const auto exr = read_image(folder_ / "s.exr");
  ASSERT_TRUE(exr) << exr.error().message;
  EXPECT_EQ(exr->attribute("penumbra:incomplete"), MetadataValue(1));
  EXPECT_GE(exr->at(12, 10, *exr->channel("samples.Y")), 64.0f)
      << "a second is enough for a pass of this scene";
  EXPECT_EQ(nlohmann::json::parse(file_contents(folder_ / "s.json"))["complete"], false);
  EXPECT_EQ(nlohmann::json::parse(file_contents(folder_ / "s.json"))["ended_by"], "interrupt");
}

TEST(InterruptedRender, IsRepeatedByItsRecordedCommand) {
  // One tile: its pixels have equally many samples whenever the render ends.
  const TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  Program program(folder.path(),
                  {"render", "s.xml", "--sampler", "sobol", "--spp", "1000000000", "--pass", "64"});
  ASSERT_TRUE(eventually([&] { return !children_of(program.pid()).empty(); }, kPatience));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  program.send_to_group(SIGINT);
  ASSERT_EQ(program.wait().exit_code, 1);
  const auto first = nlohmann::json::parse(file_contents(folder / "s.json"));
  EXPECT_EQ(first["complete"], false);
  EXPECT_EQ(first["settings"]["spp"], 1000000000);
  EXPECT_TRUE(first["nearest_command"].is_null());
  std::istringstream command(first["repeat_command"].get<std::string>());
  std::vector<std::string> words;
  for (std::string word; command >> word;) words.push_back(word);
  words.erase(words.begin());
  words.insert(words.end(), {"-o", "again.exr"});
  const auto result = run_penumbra(folder.path(), words);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto again = nlohmann::json::parse(file_contents(folder / "again.json"));
  EXPECT_EQ(again["film_hash"], first["film_hash"]);
  EXPECT_EQ(again["complete"], true);
}

/// A render whose report goes to a pipe that nobody reads yet: the images are there, and it is still writing.
TEST(InterruptedWriting, CtrlCLeavesWholeFilesAndTheRenderIsDone) {
  TemporaryFolder folder;
  write_small_scene(folder / "s.xml");
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  Program program(folder.path(), {"render", "s.xml", "--report", "pipe"});
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder / "s.exr"); }, kPatience));
  program.send(SIGINT);
  std::ifstream pipe(folder / "pipe");
  const auto report = nlohmann::json::parse(pipe, nullptr, false);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  ASSERT_TRUE(report.is_object());
  EXPECT_TRUE(report["complete"]);
  EXPECT_TRUE(read_image(folder / "s.exr"));
  EXPECT_TRUE(read_image(folder / "s.png"));
  for (const std::string& name : folder.names()) EXPECT_THAT(name, Not(HasSubstr(".part")));
}

TEST_F(Interrupt, TermIsLikeCtrlC) {
  program_->send(SIGTERM);
  EXPECT_EQ(program_->wait().exit_code, 1);
  expect_no_orphans();
}

TEST_F(Interrupt, AClosedTerminalKeepsWhatIsMerged) {
  program_->send(SIGHUP);
  program_->send(SIGHUP);  // the terminal's and the shell's
  const ProgramResult result = program_->wait();
  EXPECT_EQ(result.exit_code, 1) << result.err;
  expect_no_orphans();
  EXPECT_THAT(folder_.names(), ElementsAre("s.exr", "s.exr.checkpoint", "s.json", "s.png", "s.xml"));
}

TEST_F(Interrupt, NoOrphansAfterKill) {
  program_->send(SIGKILL);
  EXPECT_EQ(program_->wait().signal, SIGKILL);
  expect_no_orphans();
}

}  // namespace
}  // namespace penumbra
