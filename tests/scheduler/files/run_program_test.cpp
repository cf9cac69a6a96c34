#include "scheduler/files/run_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <thread>

#include "tests/support/fake_processes.h"
#include "tests/support/temporary_folder.h"

namespace penumbra::run_program_test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

Expected<ProgramEnd> shell(const std::string& line, const ProgramOptions& options = {}) {
  return run_program("/bin/sh", {"-c", line}, options);
}

TEST(RunProgram, SaysHowItEnded) {
  const auto good = shell("echo out; echo err >&2");
  EXPECT_TRUE(good->succeeded);
  EXPECT_EQ(good->output, "out\n");
  EXPECT_EQ(good->how, "exit code 0");
  const auto bad = shell("echo err >&2; exit 3", {.errors_too = true});
  EXPECT_FALSE(bad->succeeded);
  EXPECT_EQ(bad->output, "err\n");
  EXPECT_EQ(bad->how, "exit code 3");
  EXPECT_THAT(shell("kill -9 $$")->how, HasSubstr("killed by signal 9"));
  EXPECT_THAT(run_program("/none/none", {}).error().message, HasSubstr("cannot start /none/none"));
}

/// The process whose number the file holds, once it is there.
pid_t pid_in(const std::filesystem::path& file) {
  while (file_contents(file).find('\n') == std::string::npos) std::this_thread::sleep_for(1ms);
  return std::stoi(file_contents(file));
}

bool ends_soon(pid_t pid) {
  return eventually([pid] { return process_state(pid) == 0 || process_state(pid) == 'Z'; }, 10s);
}

TEST(RunProgram, EndsAtItsLimitOrWhenItIsStopped) {
  EXPECT_THAT(shell("exec sleep 60", {.limit = 1s}).error().message, HasSubstr("did not end within 1 s"));
  const TemporaryFolder folder;
  std::atomic<bool> stop = false;
  std::jthread stopper([&] {
    pid_in(folder / "pid");
    stop = true;
  });
  const auto end = shell("echo $$ > pid; exec sleep 60", {.folder = folder.path(), .stop = &stop});
  ASSERT_FALSE(end);
  EXPECT_THAT(end.error().message, HasSubstr("was stopped"));
  EXPECT_TRUE(ends_soon(pid_in(folder / "pid")));
}

TEST(RunProgram, DoesNotOutliveThisProcess) {
  const TemporaryFolder folder;
  const pid_t caller = fork();
  if (caller == 0) {
    (void)shell("echo $$ > pid; exec sleep 60", {.folder = folder.path()});
    _exit(0);
  }
  const pid_t program = pid_in(folder / "pid");
  kill(caller, SIGKILL);
  EXPECT_TRUE(ends_soon(program));
}

}  // namespace
}  // namespace penumbra::run_program_test
