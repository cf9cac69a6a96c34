// Keeps a number of local worker processes going: starts them, replaces those that end, ends those that hang.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/farm/child_processes.h"
#include "scheduler/farm/worker_command.h"
#include "scheduler/plan/plan.h"

namespace penumbra {

/// All times are seconds of one monotonic clock. A launcher's workers, and when they come, are its own
/// affair: its process is looked after, they are known by its key. The rules of ChildProcesses about threads
/// hold.
class WorkerProcesses {
 public:
  /// Of a launcher there is one: when it ends, it is started again, as long as its workers do anything.
  WorkerProcesses(WorkerCommand command, int wanted);

  /// Starts what is missing, unless workers keep ending before they have done anything. After one that was
  /// killed before it was ready there is a pause, longer each time.
  void start_missing(Seconds now);
  /// A process that is not ready yet has shown that it is alive.
  void is_heard_of(int pid, Seconds now);
  /// Ends those that are not ready in time or not heard of, and says which processes have ended.
  std::vector<ChildExit> look_after(Seconds now);
  /// The process that was started with this key, which no other process knows; 0 if there is none, or if the
  /// key has been used before. A worker is identified by nothing else.
  int claim(const std::string& key);
  /// Whether a worker with this key was started by the launcher, all of whose workers have the same one.
  [[nodiscard]] bool has_launched(const std::string& key) const {
    return command_.is_launcher && !key.empty() && key == launch_key_;
  }
  [[nodiscard]] bool launches() const { return command_.is_launcher; }
  /// The worker has said that it is ready.
  void is_ready(int pid) { starting_.erase(pid); }
  /// A unit has been finished: workers that end from here on have a fresh account.
  void has_worked() { failed_starts_ = fruitless_deaths_ = 0; }
  void kill(int pid) { children_.kill(pid); }
  void stop_all();
  [[nodiscard]] std::size_t running() const { return children_.running().size(); }
  /// Or will be started.
  [[nodiscard]] bool any_left() const { return running() > 0 || will_start(); }
  /// What could not be done, for people; each once.
  [[nodiscard]] std::vector<std::string> take_problems();
  /// What is waited for, likewise.
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
  std::map<int, Start> starting_;    // by pid: those that are not ready yet
  std::map<std::string, int> keys_;  // not claimed yet, and whose they are
  int failed_starts_ = 0, fruitless_deaths_ = 0;
  Seconds next_start_ = 0;
  std::vector<std::string> problems_, notices_;
};

}  // namespace penumbra
