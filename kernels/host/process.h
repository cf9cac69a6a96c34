// This process, its user, its machine and the time.
#pragma once

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace penumbra {

/// The host name, or empty.
inline std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

/// A folder of the user: the path in the environment variable (such as XDG_CACHE_HOME) if it is absolute
/// (relative ones must be ignored, XDG Base Directory Specification), else `within_home` in the user's home;
/// empty without a home.
inline std::filesystem::path user_folder(const char* variable, std::string_view within_home) {
  if (const char* folder = std::getenv(variable); folder != nullptr && *folder == '/') return folder;
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / within_home;
  return {};
}

/// Peak resident memory of this process in bytes; 0 if unknown. (ru_maxrss of getrusage does not work: it
/// includes what the process had between fork and exec, which is all of its parent's memory.)
std::uint64_t peak_memory_bytes();

/// The linker's identifications (build IDs) of this program and of its loaded libraries whose file names
/// begin so. Other code has another one. Empty for a program that was linked without.
std::string build_ids(std::initializer_list<std::string_view> libraries);

/// The current time, as "2024-06-11T17:03:00Z".
std::string utc_now();

/// Seconds since 1970.
inline double unix_time() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Seconds since `begin` on the monotonic clock.
inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// To be called between fork and exec, or right before exec: signals that this program ignores or blocks get
/// their default behaviour in the next program. (exec itself resets those that are caught.)
/// Async-signal-safe.
inline void restore_default_signals() {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int number : {SIGPIPE, SIGXFSZ, SIGCHLD}) signal(number, SIG_DFL);
}

}  // namespace penumbra
