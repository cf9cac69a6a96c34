#include "scheduler/farm/child_processes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/close_range.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string_view>
#include <thread>

#include "kernels/host/process.h"
#include "scheduler/files/run_program.h"

namespace penumbra {
namespace {

constexpr std::chrono::milliseconds kPollInterval{1};
constexpr std::chrono::milliseconds kTimeToDie{5000};
constexpr std::chrono::milliseconds kTimeToExecute{100};  // usually one or two milliseconds

/// The environment of a child: these variables, and those of this process with other names. Ends with a null
/// pointer.
std::vector<char*> with_own_environment(std::vector<std::string>& more) {
  std::vector<char*> all;
  for (std::string& variable : more) all.push_back(variable.data());
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view name =
        std::string_view(*variable).substr(0, std::string_view(*variable).find('='));
    const auto has_this_name = [&](const std::string& other) {
      return other.starts_with(name) && other.substr(name.size(), 1) == "=";
    };
    if (std::ranges::none_of(more, has_this_name)) all.push_back(*variable);
  }
  all.push_back(nullptr);
  return all;
}

/// Runs in the child between fork and exec, where only async-signal-safe functions are allowed.
[[noreturn]] void become(char* const* arguments, char* const* environment, pid_t parent, int orphan_signal,
                         int error_pipe, int output) {
  // This survives exec. If the parent died before this call, the signal will not come, so check for that.
  prctl(PR_SET_PDEATHSIG, orphan_signal);
  if (getppid() != parent) _exit(1);
  setpgid(0, 0);
  restore_default_signals();
  // They are ignored if this runs in a shell's background.
  for (const int number : {SIGINT, SIGTERM}) signal(number, SIG_DFL);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing >= 0) dup2(nothing, STDIN_FILENO);
  dup2(output, STDERR_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  // An inherited descriptor of another worker's connection would keep that connection open.
  close_range(STDERR_FILENO + 1, ~0u, CLOSE_RANGE_CLOEXEC);
  execve(arguments[0], arguments, environment);
  const int error = errno;
  [[maybe_unused]] const ssize_t written = write(error_pipe, &error, sizeof error);
  _exit(127);
}

}  // namespace

ChildProcesses::ChildProcesses(std::string executable, std::vector<std::string> arguments, ChildEnd end)
    : executable_(std::move(executable)), arguments_(std::move(arguments)), end_(end) {}

Expected<pid_t> ChildProcesses::start(std::vector<std::string> environment) {
  std::vector<char*> arguments;
  arguments.push_back(executable_.data());
  for (std::string& argument : arguments_) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  const std::vector<char*> variables = with_own_environment(environment);

  int error_pipe[2];  // a successful exec closes it
  if (pipe2(error_pipe, O_CLOEXEC | O_NONBLOCK) != 0) {
    return fail(fmt::format("cannot start '{}': {}", executable_, std::strerror(errno)));
  }
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0)
    become(arguments.data(), variables.data(), parent, end_.signal_of_orphans, error_pipe[1], output_);
  const int fork_error = errno;
  close(error_pipe[1]);
  if (child < 0) {
    close(error_pipe[0]);
    return fail(fmt::format("cannot start '{}': {}", executable_, std::strerror(fork_error)));
  }
  running_.push_back(child);
  error_pipes_[child] = error_pipe[0];
  // Readable: exec failed. Closed: exec succeeded.
  pollfd entry{.fd = error_pipe[0], .events = POLLIN, .revents = 0};
  if (poll(&entry, 1, int(kTimeToExecute.count())) <= 0) return child;
  if (std::string why = why_not_executed(child); !why.empty()) {
    waitpid(child, nullptr, 0);  // it ends at once
    std::erase(running_, child);
    return fail(std::move(why));
  }
  return child;
}

std::string ChildProcesses::why_not_executed(pid_t pid) {
  const auto pipe = error_pipes_.find(pid);
  if (pipe == error_pipes_.end()) return {};
  int exec_error = 0;
  const ssize_t got = read(pipe->second, &exec_error, sizeof exec_error);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return {};
  close(pipe->second);
  error_pipes_.erase(pipe);
  if (got != ssize_t(sizeof exec_error)) return {};
  return fmt::format("cannot start '{}': {}", executable_, std::strerror(exec_error));
}

std::vector<ChildExit> ChildProcesses::reap() {
  std::vector<ChildExit> ended;
  std::erase_if(running_, [&](pid_t pid) {
    int status = 0;
    const pid_t got = waitpid(pid, &status, WNOHANG);
    if (got == 0 || (got < 0 && errno != ECHILD)) return false;
    const std::string why = why_not_executed(pid);
    if (const auto pipe = error_pipes_.find(pid); pipe != error_pipes_.end()) {
      close(pipe->second);
      error_pipes_.erase(pipe);
    }
    if (got == pid)  // otherwise other code in this process has reaped it
      ended.push_back({pid, why.empty() ? describe_exit(status) : why,
                       WIFEXITED(status) ? std::optional(WEXITSTATUS(status)) : std::nullopt,
                       WIFSIGNALED(status) ? WTERMSIG(status) : 0});
    return true;
  });
  return ended;
}

void ChildProcesses::kill(pid_t pid) {
  if (std::ranges::find(running_, pid) != running_.end()) ::kill(pid, SIGKILL);
}

void ChildProcesses::wait_for_all(std::chrono::milliseconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (reap(), !running_.empty() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(kPollInterval);
}

void ChildProcesses::stop_all() {
  for (const pid_t pid : running_) {
    ::kill(pid, SIGTERM);
    ::kill(pid, SIGCONT);  // a stopped process handles no other signal
  }
  wait_for_all(end_.patience);
  for (const pid_t pid : running_) ::kill(pid, SIGKILL);
  wait_for_all(kTimeToDie);
}

}  // namespace penumbra
