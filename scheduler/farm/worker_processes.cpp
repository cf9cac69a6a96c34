#include "scheduler/farm/worker_processes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include "scheduler/farm/access.h"
#include "worker/protocol/token.h"

namespace penumbra {
namespace {

// After so many workers that ended before they were ready, no more are started.
constexpr int kStartsInARow = 3;
// The number of deaths without a finished unit in between. A unit that kills its workers is found out after
// at most four deaths per worker.
constexpr int deaths_allowed(int workers) { return 4 * workers + 4; }
// The number of workers in a row that somebody killed before they were ready: no unit is to blame, and with
// the pauses below all of them take some twenty seconds.
constexpr int kills_allowed(int workers) { return 10 * workers + 4; }
// Whatever kills workers before they are ready may go on for a moment.
Seconds pause_after(int deaths) { return std::min(2.0, 0.1 * std::exp2(deaths)); }
// A launcher ends with its workers, which were dismissed. When it is asked to end, it passes that on to them.
// If this process dies, it gets no harder signal, so that it can remove its job from a queue.
constexpr std::chrono::milliseconds kTimeToEndDismissed{2000};
constexpr ChildEnd kLauncherEnd{.patience = std::chrono::milliseconds(10'000), .signal_of_orphans = SIGTERM};
constexpr Seconds kTimeToBeReady = 300;  // from its start; it may have to compile kernels
// Timeouts before the worker connects, and then without a heartbeat (one per second), long enough for a busy
// machine. Delays beyond kPatience are reported.
constexpr Seconds kTimeToBeHeardOf = 30, kPatience = 5;

bool is_from_outside(const ChildExit& exit) {
  return exit.signal == SIGKILL || exit.signal == SIGTERM || exit.signal == SIGINT || exit.signal == SIGHUP;
}

}  // namespace

WorkerProcesses::WorkerProcesses(WorkerCommand command, int wanted)
    : command_(std::move(command)),
      children_(command_.program, command_.arguments, command_.is_launcher ? kLauncherEnd : ChildEnd{}),
      wanted_(command_.is_launcher ? 1 : wanted) {}

void WorkerProcesses::start_missing(Seconds now) {
  while (now >= next_start_ && will_start()) {
    std::string key = make_token();
    std::vector<std::string> environment = command_.environment;
    environment.push_back(fmt::format("{}={}", kWorkerKeyVariable, key));
    const Expected<pid_t> pid = children_.start(std::move(environment));
    if (pid && launches()) {
      launch_key_ = std::move(key);  // a queue may keep its workers waiting for any time
    } else if (pid) {
      keys_[std::move(key)] = *pid;
      starting_[*pid] = {.since = now, .heard_at = now};
    } else {
      problems_.push_back(pid.error().message);
      failed_starts_ = kStartsInARow;  // trying again would not help
    }
  }
}

bool WorkerProcesses::will_start() const {
  return int(running()) < wanted_ && failed_starts_ < kStartsInARow &&
         killed_starts_ < kills_allowed(wanted_) && deaths_without_result_ < deaths_allowed(wanted_);
}

void WorkerProcesses::is_heard_of(int pid, Seconds now) {
  const auto found = starting_.find(pid);
  if (found == starting_.end()) return;
  found->second.heard_at = now;
  found->second.is_connected = true;
  found->second.is_told = false;
}

/// Its end is noticed like that of any other process.
void WorkerProcesses::end_start(int pid, Start& start, Seconds now, const std::string& why) {
  problems_.push_back(fmt::format("the worker process {} was ended: {}", pid, why));
  children_.kill(pid);
  start = {.since = now, .heard_at = now, .is_told = true, .is_ended = true};
}

std::vector<ChildExit> WorkerProcesses::look_after(Seconds now) {
  for (auto& [pid, start] : starting_) {
    const char* silence = start.is_connected ? "not heard of" : "not connected";
    if (now - start.since >= kTimeToBeReady) {
      end_start(pid, start, now, fmt::format("not ready after {} s", kTimeToBeReady));
    } else if (now - start.heard_at >= kTimeToBeHeardOf) {
      end_start(pid, start, now, fmt::format("{} for {} s", silence, kTimeToBeHeardOf));
    } else if (!start.is_told && now - start.heard_at >= kPatience) {
      start.is_told = true;
      notices_.push_back(
          fmt::format("waiting for the worker process {}, which is starting and was {} for {} s", pid,
                      silence, kPatience));
    }
  }
  std::vector<ChildExit> ends = children_.reap();
  for (const ChildExit& exit : ends) {
    std::erase_if(keys_, [&](const auto& key) { return key.second == exit.pid; });
    const auto start = starting_.find(exit.pid);
    const bool was_starting = start != starting_.end();
    const bool was_killed = was_starting && !start->second.is_ended && is_from_outside(exit);
    if (was_starting) starting_.erase(start);
    if (was_killed) {
      next_start_ = now + pause_after(killed_starts_++);
      continue;
    }
    ++(was_starting || launches() ? failed_starts_ : deaths_without_result_);
  }
  return ends;
}

void WorkerProcesses::stop_all() {
  if (launches()) children_.wait_for_all(kTimeToEndDismissed);
  children_.stop_all();
}

std::vector<std::string> WorkerProcesses::take_notices() { return std::exchange(notices_, {}); }

int WorkerProcesses::claim(const std::string& key) {
  // Compares with all keys in constant time, because workers started by others may try keys too.
  auto found = keys_.end();
  for (auto at = keys_.begin(); at != keys_.end(); ++at)
    if (are_equal_secrets(at->first, key)) found = at;
  if (found == keys_.end()) return 0;
  const int pid = found->second;
  keys_.erase(found);
  return pid;
}

std::vector<std::string> WorkerProcesses::take_problems() { return std::exchange(problems_, {}); }

}  // namespace penumbra
