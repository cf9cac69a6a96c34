#include "scheduler/worker_processes.h"

#include <fmt/format.h>

#include <utility>

#include "scheduler/access.h"
#include "scheduler/protocol/token.h"

namespace penumbra {
namespace {

constexpr int kStartsInARow = 3;  // workers that end before they are ready; then no more are started
// Deaths with no unit finished in between. A unit that kills its workers needs up to four of them to be found
// out.
constexpr int fruitless_deaths_allowed(int workers) { return 4 * workers + 4; }
constexpr Seconds kTimeToBeReady = 300;  // from the start; it may have to compile kernels

}  // namespace

WorkerProcesses::WorkerProcesses(const std::string& executable, const std::string& address, int wanted)
    : children_(executable, {"--connect", address}), wanted_(wanted) {}

void WorkerProcesses::start_missing(Seconds now) {
  while (int(children_.running().size()) < wanted_ && failed_starts_ < kStartsInARow &&
         fruitless_deaths_ < fruitless_deaths_allowed(wanted_)) {
    std::string key = make_token();
    const Expected<pid_t> pid = children_.start({fmt::format("{}={}", kWorkerKeyVariable, key)});
    if (pid) {
      keys_[std::move(key)] = *pid;
      starting_[*pid] = now;
    } else {
      problems_.push_back(pid.error().message);
      failed_starts_ = kStartsInARow;  // trying again would not help
    }
  }
}

std::vector<WorkerEnd> WorkerProcesses::look_after(Seconds now) {
  for (auto& [pid, start] : starting_) {
    if (now - start < kTimeToBeReady) continue;
    problems_.push_back(
        fmt::format("the worker process {} was ended: not ready after {} s", pid, kTimeToBeReady));
    children_.kill(pid);
    start = now;
  }
  std::vector<WorkerEnd> ends;
  for (ChildExit& exit : children_.reap()) {
    std::erase_if(keys_, [&](const auto& key) { return key.second == exit.pid; });
    const bool was_starting = starting_.erase(exit.pid) > 0;
    ++(was_starting ? failed_starts_ : fruitless_deaths_);
    ends.push_back({std::move(exit), was_starting});
  }
  return ends;
}

int WorkerProcesses::claim(const std::string& key) {
  const auto found = keys_.extract(key);
  return found ? found.mapped() : 0;
}

std::vector<std::string> WorkerProcesses::take_problems() { return std::exchange(problems_, {}); }

}  // namespace penumbra
