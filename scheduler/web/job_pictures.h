// The pictures of jobs, each made once for all browsers that ask for it.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "scheduler/web/live_films.h"
#include "scheduler/web/web_content.h"

namespace penumbra {

/// Thread-safe. One picture of a film and one of a file are made at a time, so that browsers take little from
/// the workers, and a slow disk does not keep films waiting.
class JobPictures {
 public:
  JobPictures();

  /// The films of the jobs that are being rendered.
  [[nodiscard]] LiveFilms& films() { return films_; }

  /// The picture of a job that is being rendered. At most one a second is made of a job in each size.
  std::optional<WebPicture> of_film(JobId job, int largest_side);
  /// The picture of a job that is over, from its image file, which does not change any more. Nothing if the
  /// file cannot be read, or is too large for this.
  std::optional<WebPicture> of_file(JobId job, const std::filesystem::path& file, int largest_side);

 private:
  using Clock = std::chrono::steady_clock;
  using Key = std::pair<JobId, int>;
  struct Kept {
    std::uint64_t version = 0;
    WebPicture picture;
    Clock::time_point made;
    std::list<Key>::iterator place;  // in last_used_
  };

  [[nodiscard]] std::optional<Kept> find(const Key& key);
  WebPicture keep(const Key& key, std::uint64_t version, std::string png);

  LiveFilms films_;
  const std::string run_;  // part of the tags: an earlier process may have counted its versions alike
  std::mutex making_film_, reading_file_;
  std::mutex mutex_;  // protects what follows
  std::map<Key, Kept> kept_;
  std::list<Key> last_used_;  // most recent first
  std::size_t bytes_ = 0;
};

}  // namespace penumbra
