#include "scheduler/files/run_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <thread>

#include "kernels/host/process.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kNotStarted = 127;

/// Runs in the child between fork and exec, where only async-signal-safe functions are allowed.
[[noreturn]] void become(char* const* words, pid_t parent, int output, const char* folder, bool errors_too) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kNotStarted);
  restore_default_signals();
  if (*folder != 0 && chdir(folder) != 0) _exit(kNotStarted);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing >= 0) dup2(nothing, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  if (errors_too) dup2(output, STDERR_FILENO);
  execv(words[0], words);
  _exit(kNotStarted);
}

/// Until when a program may run.
struct Patience {
  Clock::time_point deadline;
  const std::atomic<bool>* stop;

  [[nodiscard]] bool is_stopped() const { return stop != nullptr && *stop; }
  [[nodiscard]] bool is_over() const { return is_stopped() || Clock::now() >= deadline; }
};

/// Reads until the other end is closed. False if patience ends first.
bool read_all(int descriptor, const Patience& patience, std::string& text) {
  constexpr std::chrono::milliseconds kBetweenLooks{50};
  char part[4096];
  for (;;) {
    pollfd entry{.fd = descriptor, .events = POLLIN, .revents = 0};
    if (patience.is_over()) return false;
    if (poll(&entry, 1, int(kBetweenLooks.count())) <= 0) continue;
    const ssize_t got = read(descriptor, part, sizeof part);
    if (got == 0 || (got < 0 && errno != EINTR)) return true;
    if (got > 0) text.append(part, std::size_t(got));
  }
}

/// The exit status of a child, which may close its output before it ends. Nothing if patience ends first.
std::optional<int> wait_for(pid_t child, const Patience& patience) {
  constexpr std::chrono::milliseconds kWaitInterval{2};
  for (;;) {
    int status = 0;
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if ((ended < 0 && errno != EINTR) || patience.is_over()) return std::nullopt;
    std::this_thread::sleep_for(kWaitInterval);
  }
}

}  // namespace

std::string describe_exit(int status) {
  return WIFSIGNALED(status)
             ? fmt::format("killed by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))
             : fmt::format("exit code {}", WEXITSTATUS(status));
}

Expected<ProgramEnd> run_program(std::string program, std::vector<std::string> arguments,
                                 const ProgramOptions& options) {
  std::vector<char*> words{program.data()};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  int output[2];
  if (pipe2(output, O_CLOEXEC) != 0)
    return fail(fmt::format("cannot start {}: {}", program, std::strerror(errno)));
  const Patience patience{Clock::now() + options.limit, options.stop};
  const pid_t parent = getpid();
  const pid_t child = fork();
  const int fork_error = errno;
  if (child == 0) become(words.data(), parent, output[1], options.folder.c_str(), options.errors_too);
  close(output[1]);
  ProgramEnd end;
  const bool read = child > 0 && read_all(output[0], patience, end.output);
  close(output[0]);
  if (child < 0) return fail(fmt::format("cannot start {}: {}", program, std::strerror(fork_error)));
  const std::optional<int> status = read ? wait_for(child, patience) : std::nullopt;
  if (!status) {
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    return fail(patience.is_stopped()
                    ? fmt::format("{} was stopped", program)
                    : fmt::format("{} did not end within {} s", program, options.limit.count()));
  }
  if (WIFEXITED(*status) && WEXITSTATUS(*status) == kNotStarted && end.output.empty())
    return fail(fmt::format("cannot start {}", program));
  end.how = describe_exit(*status);
  end.succeeded = WIFEXITED(*status) && WEXITSTATUS(*status) == 0;
  return end;
}

}  // namespace penumbra
