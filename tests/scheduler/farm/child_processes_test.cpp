#include "scheduler/farm/child_processes.h"

#include <gmock/gmock.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "tests/support/fake_processes.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Processes that run a line of shell.
ChildProcesses shells(const char* line) { return {"/bin/sh", {"-c", line}}; }

std::vector<ChildExit> reap_one(ChildProcesses& workers) {
  std::vector<ChildExit> ended;
  EXPECT_TRUE(eventually([&] { return !(ended = workers.reap()).empty(); }, 30s));
  return ended;
}

TEST(ChildProcesses, SaysHowAProcessEnded) {
  ChildProcesses workers = shells("exit 7");
  const pid_t pid = workers.start().value();
  const auto ended = reap_one(workers);
  ASSERT_THAT(ended, SizeIs(1));
  EXPECT_EQ(ended[0].pid, pid);
  EXPECT_EQ(ended[0].how, "exit code 7");
  EXPECT_THAT(workers.running(), IsEmpty());
}

TEST(ChildProcesses, SaysWhichSignalKilledAProcess) {
  ChildProcesses workers = shells("kill -SEGV $$");
  ASSERT_TRUE(workers.start());
  EXPECT_THAT(reap_one(workers)[0].how, HasSubstr("signal 11 (Segmentation fault"));
}

TEST(ChildProcesses, KillsOne) {
  ChildProcesses workers = shells("exec sleep 100");
  const pid_t victim = workers.start().value();
  const pid_t other = workers.start().value();
  workers.kill(victim);
  EXPECT_EQ(reap_one(workers)[0].pid, victim);
  EXPECT_THAT(workers.running(), testing::ElementsAre(other));
}

TEST(ChildProcesses, StopsTheStoppedAndTheStubborn) {
  ChildProcesses workers = shells("trap '' TERM; exec sleep 100");
  std::vector<pid_t> pids;
  for (int i = 0; i < 3; ++i) pids.push_back(workers.start().value());
  ASSERT_TRUE(eventually([&] { return process_state(pids[0]) == 'S'; }, 30s));
  kill(pids[0], SIGSTOP);
  ASSERT_TRUE(eventually([&] { return process_state(pids[0]) == 'T'; }, 30s));
  workers.stop_all();
  EXPECT_THAT(workers.running(), IsEmpty());
  for (const pid_t pid : pids) EXPECT_EQ(process_state(pid), 0);
}

std::atomic<bool> stops_before_it_executes = false;

TEST(ChildProcesses, AChildThatIsStoppedBeforeItExecutesDelaysNothing) {
  // The handler runs in the child, within fork().
  static const int registered =
      pthread_atfork(nullptr, nullptr, [] { stops_before_it_executes ? void(raise(SIGSTOP)) : void(); });
  ASSERT_EQ(registered, 0);
  const pid_t self = getpid();
  std::atomic<bool> rescued = false;
  std::jthread rescue([&](const std::stop_token& stop) {
    if (eventually([&] { return stop.stop_requested(); }, 20s)) return;
    rescued = true;
    for (const pid_t child : children_of(self)) kill(child, SIGKILL);
  });
  ChildProcesses workers = shells("exit 7");
  stops_before_it_executes = true;
  const Expected<pid_t> stopped = workers.start();
  stops_before_it_executes = false;
  ASSERT_TRUE(stopped) << stopped.error().message;
  EXPECT_FALSE(rescued) << "start() waited for the child";
  EXPECT_EQ(process_state(*stopped), 'T');
  EXPECT_THAT(workers.reap(), IsEmpty());
  kill(*stopped, SIGCONT);
  EXPECT_EQ(reap_one(workers)[0].how, "exit code 7");

  ChildProcesses missing("/no/such/program", {});
  stops_before_it_executes = true;
  ASSERT_TRUE(missing.start()) << "it is not known yet";
  stops_before_it_executes = false;
  kill(missing.running()[0], SIGCONT);
  EXPECT_THAT(reap_one(missing)[0].how, HasSubstr("cannot start '/no/such/program': No such file"));

  stops_before_it_executes = true;
  ASSERT_TRUE(workers.start());
  stops_before_it_executes = false;
  workers.stop_all();
  EXPECT_THAT(workers.running(), IsEmpty());
  EXPECT_FALSE(rescued);
}

TEST(ChildProcesses, NothingIsInheritedButStandardError) {
  // A file that this process has open without close-on-exec must not be open in the worker.
  char name[] = "/tmp/penumbra-leak-XXXXXX";
  const int leak = mkstemp(name);
  ASSERT_GE(leak, 0);
  ChildProcesses workers = shells("[ -e /proc/self/fd/$LEAK ] && exit 1; read line && exit 2; exit 0");
  setenv("LEAK", std::to_string(leak).c_str(), 1);
  ASSERT_TRUE(workers.start());
  EXPECT_EQ(reap_one(workers)[0].how, "exit code 0");
  close(leak);
  unlink(name);
}

TEST(ChildProcesses, VariablesThatAreGivenReplaceThoseOfThisProcess) {
  ChildProcesses workers = shells(
      "[ \"$(grep -zc '^PENUMBRA_GIVEN=' /proc/$$/environ)\" = 1 ] && "
      "[ \"$PENUMBRA_GIVEN $PENUMBRA_GIV\" = 'new kept' ]");
  setenv("PENUMBRA_GIVEN", "old", 1);
  setenv("PENUMBRA_GIV", "kept", 1);  // the other name begins with this one
  ASSERT_TRUE(workers.start({"PENUMBRA_GIVEN=new"}));
  EXPECT_EQ(reap_one(workers)[0].how, "exit code 0");
  unsetenv("PENUMBRA_GIVEN");
  unsetenv("PENUMBRA_GIV");
}

TEST(ChildProcesses, CtrlCAtTheTerminalDoesNotReachThem) {
  ChildProcesses workers = shells("exec sleep 100");
  const pid_t pid = workers.start().value();
  EXPECT_TRUE(eventually([&] { return getpgid(pid) == pid; }, 30s));
  EXPECT_NE(getpgid(pid), getpgrp());
}

TEST(ChildProcesses, AMissingProgramIsAnError) {
  ChildProcesses workers("/no/such/program", {});
  const auto started = workers.start();
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("'/no/such/program': No such file or directory"));
  EXPECT_THAT(workers.running(), IsEmpty());
}

}  // namespace
}  // namespace penumbra
