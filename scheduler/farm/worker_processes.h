// Keeps a number of local worker processes running: starts them, replaces those that end, kills those that
// hang.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/farm/child_processes.h"
#include "scheduler/farm/worker_command.h"
#include "scheduler/plan/plan.h"

namespace penumbra {

/// All times are seconds of one monotonic clock. With a launcher, only the launcher's process is monitored;
/// its workers come and go independently, and are recognised by the launcher's key. The rules of
/// ChildProcesses about threads apply.
class WorkerProcesses {
 public:
  /// There is only one launcher process. If it ends, it is started again, unless its workers never finish
  /// anything.
  WorkerProcesses(WorkerCommand command, int wanted);

  /// Starts missing processes, unless workers keep ending before they have finished anything. After a worker
  /// that was killed before it was ready it pauses, longer each time.
  void start_missing(Seconds now);
  /// A process that is not ready yet has given a sign of life.
  void is_heard_of(int pid, Seconds now);
  /// Kills processes that are not ready in time or give no sign of life. Returns the processes that have
  /// ended.
  std::vector<ChildExit> look_after(Seconds now);
  /// The pid of the process that was started with this key. Only that process knows the key, and a worker is
  /// identified by nothing else. 0 if there is none, or if the key has been used before.
  int claim(const std::string& key);
  /// Whether a worker with this key was started by the launcher. All workers of a launcher share one key.
  [[nodiscard]] bool has_launched(const std::string& key) const {
    return command_.is_launcher && !key.empty() && key == launch_key_;
  }
  [[nodiscard]] bool launches() const { return command_.is_launcher; }
  /// The worker has reported that it is ready.
  void is_ready(int pid) { starting_.erase(pid); }
  /// A unit has been finished, so the counts of failures begin again at 0.
  void has_worked() { failed_starts_ = killed_starts_ = deaths_without_result_ = 0; }
  void kill(int pid) { children_.kill(pid); }
  void stop_all();
  [[nodiscard]] std::size_t running() const { return children_.running().size(); }
  /// Whether processes are running or will be started.
  [[nodiscard]] bool any_left() const { return running() > 0 || will_start(); }
  /// Problems for the user; each is returned once.
  [[nodiscard]] std::vector<std::string> take_problems();
  /// Notices about what is being waited for; each is returned once.
  [[nodiscard]] std::vector<std::string> take_notices();

 private:
  struct Start;
  [[nodiscard]] bool will_start() const;
  void end_start(int pid, Start& start, Seconds now, const std::string& why);

  WorkerCommand command_;
  ChildProcesses children_;
  int wanted_;
  std::string launch_key_;
  struct Start {
    Seconds since = 0, heard_at = 0;
    bool is_connected = false, is_told = false, is_ended = false;
  };
  std::map<int, Start> starting_;    // processes that are not ready yet, by pid
  std::map<std::string, int> keys_;  // keys that have not been claimed yet, and the pids of their processes
  int failed_starts_ = 0, killed_starts_ = 0, deaths_without_result_ = 0;
  Seconds next_start_ = 0;
  std::vector<std::string> problems_, notices_;
};

}  // namespace penumbra
