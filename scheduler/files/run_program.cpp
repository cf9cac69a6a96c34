#include "scheduler/files/run_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
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
[[noreturn]] void become(char* const* words, int output, const char* folder, bool errors_too) {
  restore_default_signals();
  if (*folder != 0 && chdir(folder) != 0) _exit(kNotStarted);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing >= 0) dup2(nothing, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  if (errors_too) dup2(output, STDERR_FILENO);
  execv(words[0], words);
  _exit(kNotStarted);
}

/// Reads until the other end is closed. False if the deadline passes first.
bool read_all(int descriptor, Clock::time_point deadline, std::string& text) {
  char part[4096];
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    pollfd entry{.fd = descriptor, .events = POLLIN, .revents = 0};
    if (left.count() <= 0) return false;
    if (poll(&entry, 1, int(left.count())) <= 0) continue;
    const ssize_t got = read(descriptor, part, sizeof part);
    if (got == 0 || (got < 0 && errno != EINTR)) return true;
    if (got > 0) text.append(part, std::size_t(got));
  }
}

/// The exit status of a child, which may close its output before it ends. Nothing if the deadline passes
/// first.
std::optional<int> wait_for(pid_t child, Clock::time_point deadline) {
  constexpr std::chrono::milliseconds kWaitInterval{2};
  for (;;) {
    int status = 0;
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if ((ended < 0 && errno != EINTR) || Clock::now() > deadline) return std::nullopt;
    std::this_thread::sleep_for(kWaitInterval);
  }
}

}  // namespace

Expected<ProgramEnd> run_program(std::string program, std::vector<std::string> arguments,
                                 const ProgramOptions& options) {
  std::vector<char*> words{program.data()};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  int output[2];
  if (pipe2(output, O_CLOEXEC) != 0)
    return fail(fmt::format("cannot start {}: {}", program, std::strerror(errno)));
  const auto deadline = Clock::now() + options.limit;
  const pid_t child = fork();
  const int fork_error = errno;
  if (child == 0) become(words.data(), output[1], options.folder.c_str(), options.errors_too);
  close(output[1]);
  ProgramEnd end;
  const bool read = child > 0 && read_all(output[0], deadline, end.output);
  close(output[0]);
  if (child < 0) return fail(fmt::format("cannot start {}: {}", program, std::strerror(fork_error)));
  const std::optional<int> status = read ? wait_for(child, deadline) : std::nullopt;
  if (!status) {
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    return fail(fmt::format("{} did not end within {} s", program, options.limit.count()));
  }
  if (WIFEXITED(*status) && WEXITSTATUS(*status) == kNotStarted && end.output.empty())
    return fail(fmt::format("cannot start {}", program));
  end.succeeded = WIFEXITED(*status) && WEXITSTATUS(*status) == 0;
  return end;
}

}  // namespace penumbra
