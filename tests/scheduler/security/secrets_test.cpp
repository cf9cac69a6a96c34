// Keys and tokens must not be found in command lines, environments, messages, images or core dumps.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <sstream>

#include "tests/scheduler/security/preview_process.h"
#include "worker/keys/secrets.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

/// Every line of every secret file.
std::vector<std::string> secrets_of(const std::filesystem::path& keys) {
  std::vector<std::string> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(keys)) {
    const std::filesystem::path& path = entry.path();
    if (path.filename() != "key.pem" && path.extension() != ".token") continue;
    std::istringstream lines(file_contents(path));
    for (std::string line; std::getline(lines, line);)
      if (!line.starts_with("-----")) all.push_back(line);
  }
  return all;
}

TEST(Secrets, AreInNothingThatARenderLeavesOrShows) {
  SchedulerProcess render(
      {"render", "s.xml", "--threads", "1", "--workers", "2", "--spp", "30000", "--pass", "100"});
  const std::vector<std::string> secrets = secrets_of(render.folder / "keys");
  ASSERT_GT(secrets.size(), 10u);
  std::string shown;
  const TemporaryFolder elsewhere;
  std::filesystem::copy(render.folder / "keys/worker", elsewhere / "worker");
  Program worker(elsewhere.path(),
                 {"worker", "--connect", render.address, "--keys", "worker", "--threads", "1"});
  ASSERT_TRUE(
      eventually([&] { return file_contents(render.folder / ".stderr").contains("has joined"); }, 60s))
      << file_contents(render.folder / ".stderr") << file_contents(elsewhere / ".stderr");
  std::vector<pid_t> processes = children_of(render.program->pid());
  processes.push_back(render.program->pid());
  processes.push_back(worker.pid());
  for (const pid_t process : processes)
    for (const char* what : {"cmdline", "environ"})
      shown += file_contents("/proc/" + std::to_string(process) + "/" + what);
  EXPECT_THAT(shown, HasSubstr("--keys")) << "something is shown at all";
  const ProgramResult result = render.program->wait(), helped = worker.wait();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  shown += result.out + result.err + helped.out + helped.err;
  const std::string image = file_contents(render.folder / "s.exr"),
                    statistics = file_contents(render.folder / "s.json");
  EXPECT_THAT(image, HasSubstr("penumbra:"));
  EXPECT_THAT(statistics, HasSubstr("command_line"));
  for (const std::string& secret : secrets)
    for (const auto& text : {shown, image, statistics}) EXPECT_FALSE(text.contains(secret)) << secret;
}

TEST(Secrets, ATokenAmongTheWordsOfACommandIsRefused) {
  const TemporaryFolder folder;
  const ProgramResult result =
      run_penumbra(folder.path(), {"worker", "--connect", "127.0.0.1:1", "--token", "0123456789abcdef"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("PENUMBRA_TOKEN"));
  EXPECT_THAT(result.err, Not(HasSubstr("0123456789abcdef")));
}

/// How a process ends at a signal that usually leaves a core.
int end_of_child(bool has_secrets, const std::filesystem::path& folder) {
  const pid_t child = fork();
  if (child == 0) {
    rlimit all{RLIM_INFINITY, RLIM_INFINITY};
    setrlimit(RLIMIT_CORE, &all);
    [[maybe_unused]] const int changed = chdir(folder.c_str());
    prctl(PR_SET_DUMPABLE, 1);
    if (has_secrets) keep_out_of_core_dumps();
    signal(SIGQUIT, SIG_DFL);
    raise(SIGQUIT);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(Secrets, LeaveNoCore) {
  const TemporaryFolder folder;
  ASSERT_TRUE(make_keys({.folder = folder / "keys", .names = {"localhost"}}));
  prctl(PR_SET_DUMPABLE, 1);
  ASSERT_TRUE(read_keys(folder / "keys", KeyRole::kWorker));
  EXPECT_EQ(prctl(PR_GET_DUMPABLE), 0);
  prctl(PR_SET_DUMPABLE, 1);
  EXPECT_FALSE(WCOREDUMP(end_of_child(true, folder.path())));
  if (!WCOREDUMP(end_of_child(false, folder.path())))
    GTEST_SKIP() << "no process leaves a core on this machine";
}

}  // namespace
}  // namespace penumbra
