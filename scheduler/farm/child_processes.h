// Child processes on this machine, the workers above all: started, watched, reaped. None outlives this
// process, however that ends.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <csignal>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

struct ChildExit {
  pid_t pid = 0;
  std::string how;               ///< e.g. "exit code 1", "killed by signal 9 (Killed)"
  std::optional<int> code = {};  ///< its exit code, unless a signal killed it
  int signal = 0;                ///< that killed it, or 0
};

/// How children end that are asked to.
struct ChildEnd {
  std::chrono::milliseconds patience{1000};  ///< from SIGTERM to SIGKILL
  int signal_of_orphans = SIGKILL;           ///< what they get when this process dies
};

/// Each child is its own process group, so that Ctrl-C at the terminal reaches this process alone; its
/// standard error is ours, its standard output goes there too. The kernel ends a child when the *thread*
/// that started it ends, so one thread must call all members and live as long as the object.
class ChildProcesses {
 public:
  /// `arguments` without the program's name.
  ChildProcesses(std::string executable, std::vector<std::string> arguments, ChildEnd end = {});
  ChildProcesses(const ChildProcesses&) = delete;
  ChildProcesses& operator=(const ChildProcesses&) = delete;
  ~ChildProcesses() { stop_all(); }

  /// Starts one more, with these NAME=value in its environment. Fails if the program cannot be executed;
  /// where that takes longer than a moment (a child that is stopped before, a file system that does not
  /// answer) `reap` says so later.
  Expected<pid_t> start(std::vector<std::string> environment = {});
  /// The children that ended since the last call.
  std::vector<ChildExit> reap();
  /// Ends a child at once, even one that is stopped; `reap` reports it.
  void kill(pid_t pid);
  /// Asks all to end, kills those that have not after a moment, and waits until none is left; but not for
  /// ever for those that the kernel keeps even so (a file system that does not answer).
  void stop_all();
  /// Waits at most so long for all of them to end by themselves; those that did are reaped.
  void wait_for_all(std::chrono::milliseconds limit);

  [[nodiscard]] const std::vector<pid_t>& running() const { return running_; }

 private:
  std::string executable_;
  std::vector<std::string> arguments_;
  ChildEnd end_;
  /// Says why the program could not be executed, if that is known by now.
  [[nodiscard]] std::string why_not_executed(pid_t pid);

  std::vector<pid_t> running_;
  std::map<pid_t, int> error_pipes_;  // of those that have not yet executed the program, as far as is known
};

}  // namespace penumbra
