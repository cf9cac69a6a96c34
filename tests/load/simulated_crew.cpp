#include "tests/load/simulated_crew.h"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <queue>
#include <random>
#include <vector>

#include "kernels/host/process.h"
#include "tests/load/simulated_worker.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using Clock = SimulatedWorker::Clock;

constexpr auto kBeatInterval = 1s;
constexpr auto kBetweenDeaths = 50ms;

/// Things to be done at their times, by one thread.
class Agenda {
 public:
  void add(Clock::time_point at, SimulatedWorker& worker, bool is_beat) {
    bool is_first = false;
    {
      const std::lock_guard lock(mutex_);
      is_first = entries_.empty() || at < entries_.top().at;
      entries_.push({at, &worker, is_beat});
    }
    if (is_first) changed_.notify_one();
  }

  /// Does what is due, waiting for it at most so long.
  void run(Clock::time_point until) {
    std::unique_lock lock(mutex_);
    while (Clock::now() < until) {
      const auto next = entries_.empty() ? until : std::min(until, entries_.top().at);
      if (next > Clock::now()) {
        changed_.wait_until(lock, next);
        continue;
      }
      if (entries_.empty()) continue;
      const Entry entry = entries_.top();
      entries_.pop();
      lock.unlock();
      if (entry.is_beat) {
        entry.worker->beat();
        add(entry.at + kBeatInterval, *entry.worker, true);
      } else {
        entry.worker->finish_unit();
      }
      lock.lock();
    }
  }

 private:
  struct Entry {
    Clock::time_point at;
    SimulatedWorker* worker;
    bool is_beat;
    bool operator<(const Entry& other) const { return at > other.at; }
  };
  std::mutex mutex_;
  std::condition_variable changed_;
  std::priority_queue<Entry> entries_;
};

/// Units of workers that have died, until they are ordered again.
class LostUnits {
 public:
  explicit LostUnits(LoadBoard& board) : board_(board) {}
  void add(const std::deque<UnitId>& units) {
    const std::lock_guard lock(mutex_);
    for (const UnitId& unit : units) lost_[unit] = Clock::now();
    count_ = lost_.size();
  }
  void ordered(const UnitId& unit) {
    if (count_ == 0) return;
    const std::lock_guard lock(mutex_);
    const auto found = lost_.find(unit);
    if (found == lost_.end()) return;
    board_.redispatches.add(seconds_since(found->second));
    lost_.erase(found);
    count_ = lost_.size();
  }

 private:
  LoadBoard& board_;
  std::mutex mutex_;
  std::map<UnitId, Clock::time_point> lost_;
  std::atomic<std::size_t> count_ = 0;
};

}  // namespace

void run_simulated_crew(LoadBoard& board, const std::string& address, const std::string& key) {
  Agenda agenda;
  LostUnits lost(board);
  std::atomic<int> left = board.workers;
  SimulatedWorker::Crew crew{
      .board = board,
      .finish_at = [&](SimulatedWorker& worker, Clock::time_point at) { agenda.add(at, worker, false); },
      .ordered = [&](const UnitId& unit) { lost.ordered(unit); },
      .over = [&] { --left; }};
  std::deque<SimulatedWorker> workers;
  const auto begin = Clock::now();
  for (int number = 0; number < board.workers; ++number) {
    SimulatedWorker& worker = workers.emplace_back(crew, address, number == 0 ? key : "", number + 1);
    worker.start();
    // Spread over the second.
    agenda.add(begin + kBeatInterval + number * Clock::duration(kBeatInterval) / board.workers, worker, true);
  }
  int deaths = 0;
  // Never the first, which stands for the process.
  std::mt19937 random(1);
  std::deque<std::size_t> victims;
  for (std::size_t number = 1; number < workers.size(); ++number) victims.push_back(number);
  std::ranges::shuffle(victims, random);
  while (left > 0) {
    agenda.run(Clock::now() + kBetweenDeaths);
    if (deaths == board.deaths || victims.empty() || board.orders.count() == 0) continue;
    ++deaths;
    lost.add(workers[victims.front()].die());
    victims.pop_front();
  }
}

}  // namespace penumbra
