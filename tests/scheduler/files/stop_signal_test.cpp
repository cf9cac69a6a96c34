#include "scheduler/files/stop_signal.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace penumbra {
namespace {

/// How a child ends that gets `first`, looks at the flag (exit code 3 if it is not set), and gets `second`.
int status_after(int first, int second) {
  const pid_t child = fork();
  if (child == 0) {
    const std::atomic<bool>& stop = install_stop_signal();
    if (stop) _exit(2);
    std::raise(first);
    if (!stop) _exit(3);
    std::raise(second);
    _exit(0);
  }
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return status;
}

TEST(StopSignal, FirstAsksSecondKills) {
  for (const int first : {SIGINT, SIGTERM}) {
    for (const int second : {SIGINT, SIGTERM}) {
      const int status = status_after(first, second);
      ASSERT_TRUE(WIFSIGNALED(status)) << "exit code " << WEXITSTATUS(status);
      EXPECT_EQ(WTERMSIG(status), second);
    }
  }
}

TEST(StopSignal, AHangUpAsksForACleanEndAsOftenAsItComes) {
  int status = status_after(SIGHUP, SIGHUP);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  status = status_after(SIGHUP, SIGTERM);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST(StopSignal, NohupHoldsOn) {
  std::signal(SIGHUP, SIG_IGN);
  const int status = status_after(SIGHUP, SIGHUP);
  std::signal(SIGHUP, SIG_DFL);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3) << "nothing is to be stopped";
}

}  // namespace
}  // namespace penumbra
