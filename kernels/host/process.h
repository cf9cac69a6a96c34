// This process, its user and its machine.
#pragma once

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

namespace penumbra {

/// The machine's name as the system knows it, or empty.
inline std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

/// A folder of the user's: what the variable says, as XDG_CACHE_HOME, where that is absolute (a relative one
/// is to be ignored, XDG Base Directory Specification); else that folder of the user's home; empty without a
/// home.
inline std::filesystem::path user_folder(const char* variable, std::string_view within_home) {
  if (const char* folder = std::getenv(variable); folder != nullptr && *folder == '/') return folder;
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / within_home;
  return {};
}

/// The most bytes that this process has had resident; 0 if the system does not say. (ru_maxrss of getrusage
/// is no answer: it keeps what the process had between fork and exec, which is all of its parent's memory.)
std::uint64_t peak_memory_bytes();

/// Seconds that have passed, on the clock that is never set.
inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Between fork and exec, or right before an exec: signals that this program ignores or blocks act in the
/// next one as they do by default; those that it catches do by themselves. Async-signal-safe.
inline void restore_default_signals() {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int number : {SIGPIPE, SIGXFSZ, SIGCHLD}) signal(number, SIG_DFL);
}

}  // namespace penumbra
