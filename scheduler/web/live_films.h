// The films of running jobs, as far as they are rendered, for those who look at the moment.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "scheduler/watch/watch_board.h"
#include "worker/work_unit.h"

namespace penumbra {

/// The newest tiles of a film; they are shared with its board, not copied.
struct LiveFilm {
  std::uint64_t version = 0;                ///< increases with every new tile
  int x = 0, y = 0, width = 0, height = 0;  ///< the rendered rectangle of the film
  std::vector<std::shared_ptr<const TileSnapshot>> tiles = {};
};

/// Watches a job only while its film is asked for, because tiles are made only for viewers. Thread-safe.
class LiveFilms {
 public:
  LiveFilms();
  LiveFilms(const LiveFilms&) = delete;
  LiveFilms& operator=(const LiveFilms&) = delete;
  ~LiveFilms();

  /// A job has begun.
  void add(JobId job, std::shared_ptr<WatchBoard> board);
  /// Its film is not needed any more.
  void remove(JobId job);

  /// The film. If nobody has asked for it lately, this first waits for tiles, at most `patience`. Nothing if
  /// there is no such job, or it has no tiles yet.
  std::optional<LiveFilm> film(JobId job, std::chrono::milliseconds patience);

 private:
  using Clock = std::chrono::steady_clock;
  struct Watched {
    std::shared_ptr<WatchBoard> board;
    std::unique_ptr<WatchBoard::Watcher> watcher = {};  // null: nobody looks, or the job is over
    std::optional<WatchedJob> job = {};
    std::map<std::pair<int, int>, std::shared_ptr<const TileSnapshot>> tiles = {};  // by corner
    std::uint64_t version = 0;
    Clock::time_point wanted{}, last_news{};
  };

  void serve();
  static void read(Watched& watched);
  static bool is_settled(const Watched& watched);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<JobId, Watched> films_;
  bool closed_ = false;
  std::thread thread_;
};

}  // namespace penumbra
