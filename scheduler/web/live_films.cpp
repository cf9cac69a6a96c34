#include "scheduler/web/live_films.h"

#include <algorithm>

namespace penumbra {
namespace {

// Shorter than the farm's patience with a viewer at the end.
constexpr std::chrono::milliseconds kReadInterval{100};
// A board sends a few tiles at a time. After this time without a new one all of them are there.
constexpr std::chrono::milliseconds kSettled{250};
constexpr std::chrono::seconds kWatchedAfterwards{15};

}  // namespace

LiveFilms::LiveFilms() : thread_([this] { serve(); }) {}

LiveFilms::~LiveFilms() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LiveFilms::add(JobId job, std::shared_ptr<WatchBoard> board) {
  const std::lock_guard lock(mutex_);
  films_.erase(job);  // begun anew with another device
  films_.emplace(job, Watched{.board = std::move(board)});
}

void LiveFilms::remove(JobId job) {
  const std::lock_guard lock(mutex_);
  films_.erase(job);
}

bool LiveFilms::is_settled(const Watched& watched) {
  return watched.watcher == nullptr ||
         (!watched.tiles.empty() && Clock::now() - watched.last_news > kSettled);
}

std::optional<LiveFilm> LiveFilms::film(JobId job, std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  const auto found = films_.find(job);
  if (found == films_.end()) return {};
  Watched& asked = found->second;
  asked.wanted = Clock::now();
  if (!asked.watcher && !asked.job) {
    asked.watcher = std::make_unique<WatchBoard::Watcher>(*asked.board);
    asked.last_news = Clock::now();
    changed_.notify_all();
    // The job may be removed meanwhile.
    changed_.wait_for(lock, patience, [&] {
      const auto still = films_.find(job);
      return closed_ || still == films_.end() || is_settled(still->second);
    });
  }
  const auto still = films_.find(job);
  if (still == films_.end() || !still->second.job || still->second.tiles.empty()) return {};
  const Watched& watched = still->second;
  LiveFilm film{.version = watched.version,
                .x = watched.job->x,
                .y = watched.job->y,
                .width = watched.job->width,
                .height = watched.job->height};
  for (const auto& [corner, tile] : watched.tiles) film.tiles.push_back(tile);
  return film;
}

void LiveFilms::read(Watched& watched) {
  constexpr std::chrono::milliseconds kNow{0};
  if (!watched.job) watched.job = watched.watcher->job(kNow);
  while (const std::optional<WatchItem> item = watched.watcher->next(kNow)) {
    if (std::holds_alternative<WatchView>(*item)) watched.tiles.clear();
    const auto* tile = std::get_if<std::shared_ptr<const TileSnapshot>>(&*item);
    if (tile == nullptr) continue;
    watched.tiles[{(*tile)->y, (*tile)->x}] = *tile;
    ++watched.version;
    watched.last_news = Clock::now();
  }
  if (watched.watcher->at_end()) {
    watched.watcher.reset();  // the last tiles stay until the job is removed
  } else if (Clock::now() - watched.wanted > kWatchedAfterwards) {
    watched.watcher.reset();
    watched.job.reset();
    watched.tiles.clear();
  }
}

void LiveFilms::serve() {
  std::unique_lock lock(mutex_);
  const auto is_watched = [](const auto& film) { return film.second.watcher != nullptr; };
  while (!closed_) {
    if (std::ranges::none_of(films_, is_watched)) {
      changed_.wait(lock);
      continue;
    }
    for (auto& [job, watched] : films_)
      if (watched.watcher) read(watched);
    changed_.notify_all();
    changed_.wait_for(lock, kReadInterval, [this] { return closed_; });
  }
}

}  // namespace penumbra
