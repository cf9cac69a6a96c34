#include "scheduler/child_processes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/close_range.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "kernels/host/child_signals.h"

namespace penumbra {
namespace {

constexpr std::chrono::milliseconds kTimeToEnd{1000};
constexpr std::chrono::milliseconds kPollInterval{1};

std::string describe(int status) {
  if (WIFSIGNALED(status)) {
    return fmt::format("killed by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  }
  return fmt::format("exit code {}", WEXITSTATUS(status));
}

/// Runs in the child between fork and exec, where only async-signal-safe functions are allowed.
[[noreturn]] void become(char* const* arguments, pid_t parent, int error_pipe) {
  // Survives exec. If the parent died before this line, the signal will not come: hence the check.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  setpgid(0, 0);
  restore_default_signals();
  for (const int number : {SIGINT, SIGTERM}) signal(number, SIG_DFL);  // ignored where this runs behind a `&`
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing >= 0) dup2(nothing, STDIN_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  // A leaked descriptor of another worker's connection would keep that connection open.
  close_range(STDERR_FILENO + 1, ~0u, CLOSE_RANGE_CLOEXEC);
  execv(arguments[0], arguments);
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(error_pipe, &error, sizeof error);
  _exit(127);
}

}  // namespace

ChildProcesses::ChildProcesses(std::string executable, std::vector<std::string> arguments)
    : executable_(std::move(executable)), arguments_(std::move(arguments)) {}

Expected<pid_t> ChildProcesses::start() {
  std::vector<char*> arguments;
  arguments.push_back(executable_.data());
  for (std::string& argument : arguments_) arguments.push_back(argument.data());
  arguments.push_back(nullptr);

  int error_pipe[2];  // closed by a successful exec
  if (pipe2(error_pipe, O_CLOEXEC) != 0) {
    return fail(fmt::format("cannot start '{}': {}", executable_, std::strerror(errno)));
  }
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) become(arguments.data(), parent, error_pipe[1]);
  const int fork_error = errno;
  close(error_pipe[1]);
  int exec_error = 0;
  ssize_t got = 0;
  while (child > 0 && (got = read(error_pipe[0], &exec_error, sizeof exec_error)) < 0 && errno == EINTR) {
  }
  close(error_pipe[0]);
  if (child < 0) return fail(fmt::format("cannot start '{}': {}", executable_, std::strerror(fork_error)));
  if (got == ssize_t(sizeof exec_error)) {
    waitpid(child, nullptr, 0);
    return fail(fmt::format("cannot start '{}': {}", executable_, std::strerror(exec_error)));
  }
  running_.push_back(child);
  return child;
}

std::vector<ChildExit> ChildProcesses::reap() {
  std::vector<ChildExit> ended;
  std::erase_if(running_, [&](pid_t pid) {
    int status = 0;
    const pid_t got = waitpid(pid, &status, WNOHANG);
    if (got == pid) {
      ended.push_back(
          {pid, describe(status), WIFEXITED(status) ? std::optional(WEXITSTATUS(status)) : std::nullopt});
      return true;
    }
    return got < 0 && errno == ECHILD;  // somebody else in this process has reaped it
  });
  return ended;
}

void ChildProcesses::kill(pid_t pid) {
  if (std::ranges::find(running_, pid) != running_.end()) ::kill(pid, SIGKILL);
}

void ChildProcesses::stop_all() {
  for (const pid_t pid : running_) {
    ::kill(pid, SIGTERM);
    ::kill(pid, SIGCONT);  // a stopped process takes no other signal
  }
  const auto deadline = std::chrono::steady_clock::now() + kTimeToEnd;
  while (reap(), !running_.empty() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(kPollInterval);
  }
  for (const pid_t pid : running_) ::kill(pid, SIGKILL);
  while (reap(), !running_.empty()) std::this_thread::sleep_for(kPollInterval);
}

}  // namespace penumbra
