#include "scheduler/outputs/run_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "kernels/host/child_signals.h"

namespace penumbra {
namespace {

constexpr int kNotStarted = 127;

/// Runs in the child between fork and exec, where only async-signal-safe functions are allowed.
[[noreturn]] void become(char* const* words, int output, bool errors_too) {
  restore_default_signals();
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing >= 0) dup2(nothing, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  if (errors_too) dup2(output, STDERR_FILENO);
  execv(words[0], words);
  _exit(kNotStarted);
}

std::string read_all(int descriptor) {
  std::string text;
  char part[4096];
  ssize_t got = 0;
  while ((got = read(descriptor, part, sizeof part)) > 0 || (got < 0 && errno == EINTR))
    if (got > 0) text.append(part, std::size_t(got));
  return text;
}

}  // namespace

Expected<ProgramEnd> run_program(std::string program, std::vector<std::string> arguments, bool errors_too) {
  std::vector<char*> words{program.data()};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  int output[2];
  if (pipe2(output, O_CLOEXEC) != 0)
    return fail(fmt::format("cannot start {}: {}", program, std::strerror(errno)));
  const pid_t child = fork();
  const int fork_error = errno;
  if (child == 0) become(words.data(), output[1], errors_too);
  close(output[1]);
  ProgramEnd end;
  if (child > 0) end.output = read_all(output[0]);
  close(output[0]);
  if (child < 0) return fail(fmt::format("cannot start {}: {}", program, std::strerror(fork_error)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return fail(fmt::format("lost {}: {}", program, std::strerror(errno)));
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted && end.output.empty())
    return fail(fmt::format("cannot start {}", program));
  end.succeeded = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  return end;
}

}  // namespace penumbra
