// Child processes on this machine, mainly workers: starts, monitors and reaps them. None outlives this
// process, however it ends.
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
  std::string how;               ///< for messages: "exit code 1", "killed by signal 9 (Killed)"
  std::optional<int> code = {};  ///< exit code, unless a signal killed it
  int signal = 0;                ///< the signal that killed it, or 0
};

/// How children are asked to end.
struct ChildEnd {
  std::chrono::milliseconds patience{1000};  ///< time between SIGTERM and SIGKILL
  int signal_of_orphans = SIGKILL;           ///< the signal that children get if this process dies
};

/// Each child is its own process group, so that Ctrl-C at the terminal reaches only this process. Its
/// standard output and standard error both go to our standard error, or where `send_output_to` says. The
/// kernel ends a child when the *thread* that started it ends. So one thread must call all members and must
/// live as long as the object.
class ChildProcesses {
 public:
  /// `arguments` do not include the program's name.
  ChildProcesses(std::string executable, std::vector<std::string> arguments, ChildEnd end = {});
  ChildProcesses(const ChildProcesses&) = delete;
  ChildProcesses& operator=(const ChildProcesses&) = delete;
  ~ChildProcesses() { stop_all(); }

  /// What children that are started from now on write goes to this descriptor, which must stay open.
  void send_output_to(int descriptor) { output_ = descriptor; }

  /// Starts a child with these NAME=value in its environment. Fails if the program cannot be executed. If
  /// executing takes long (a stopped child, a file system that does not respond), `reap` reports the failure
  /// later.
  Expected<pid_t> start(std::vector<std::string> environment = {});
  /// The children that ended since the last call.
  std::vector<ChildExit> reap();
  /// Kills a child at once, even a stopped one; `reap` reports it.
  void kill(pid_t pid);
  /// Asks all children to end, kills the others after a moment, and waits until none is left. It does not
  /// wait for ever for children that the kernel cannot end (a file system that does not respond).
  void stop_all();
  /// Waits until all children have ended by themselves, at most for `limit`. Reaps those that have.
  void wait_for_all(std::chrono::milliseconds limit);

  [[nodiscard]] const std::vector<pid_t>& running() const { return running_; }

 private:
  std::string executable_;
  std::vector<std::string> arguments_;
  ChildEnd end_;
  int output_ = 2;
  /// Why the program could not be executed, if that is known yet.
  [[nodiscard]] std::string why_not_executed(pid_t pid);

  std::vector<pid_t> running_;
  std::map<pid_t, int> error_pipes_;  // of children that may not have executed the program yet
};

}  // namespace penumbra
