#include "scheduler/files/stop_signal.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

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

TEST(StopSignal, ComesWhenTheOwnerEndsThePipe) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[1]);
    setenv("PENUMBRA_OWNER_PIPE", std::to_string(ends[0]).c_str(), 1);
    const std::atomic<bool>& stop = install_stop_signal();
    if (stop || std::getenv("PENUMBRA_OWNER_PIPE") != nullptr) _exit(2);
    while (!stop) usleep(1000);
    _exit(4);
  }
  close(ends[0]);
  int status = 0;
  usleep(50'000);
  EXPECT_EQ(waitpid(child, &status, WNOHANG), 0) << "the owner is there";
  close(ends[1]);
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << status;
  EXPECT_EQ(WEXITSTATUS(status), 4);
}

}  // namespace
}  // namespace penumbra
