#include "scheduler/web/status_feed.h"

#include <algorithm>
#include <new>
#include <utility>

namespace penumbra {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kShareOfTime = 20;  // the time until the next look, as a multiple of what the last one took

Json without_times(Json status) {
  if (!status.is_object()) return status;
  status.erase("now");
  status.erase("up_seconds");
  if (const auto workers = status.find("workers"); workers != status.end() && workers->is_array())
    for (Json& worker : *workers)
      if (worker.is_object()) worker.erase("since_seconds");
  return status;
}

}  // namespace

StatusFeed::StatusFeed(std::function<Json()> status, std::chrono::milliseconds interval)
    : status_(std::move(status)), interval_(interval) {}

std::optional<StatusFeed::State> StatusFeed::next(std::uint64_t seen, std::chrono::milliseconds patience) {
  const Clock::time_point until = Clock::now() + patience;
  std::unique_lock lock(mutex_);
  for (;;) {
    if (!closed_ && !looking_ && Clock::now() >= next_look_) look(lock);
    if (closed_) return newest_.number > seen ? std::optional(newest_) : std::nullopt;
    // A state from before an interval without readers may be old.
    if (newest_.number > seen && (!looking_ || seen != 0)) return newest_;
    if (Clock::now() >= until) return {};
    changed_.wait_until(lock, looking_ ? until : std::min(until, next_look_));
  }
}

void StatusFeed::look(std::unique_lock<std::mutex>& lock) {
  looking_ = true;
  lock.unlock();
  const Clock::time_point begin = Clock::now();
  std::shared_ptr<const std::string> text;
  Json compared;
  try {
    Json status = status_();
    text = std::make_shared<const std::string>(status.dump(-1, ' ', false, Json::error_handler_t::replace));
    compared = without_times(std::move(status));
  } catch (const std::bad_alloc&) {
    text.reset();  // the next look may succeed
  }
  const auto took = Clock::now() - begin;
  lock.lock();
  looking_ = false;
  next_look_ = Clock::now() + std::max<Clock::duration>(interval_, kShareOfTime * took);
  if (text && (newest_.number == 0 || compared != compared_)) {
    newest_ = {newest_.number + 1, std::move(text)};
    compared_ = std::move(compared);
  }
  changed_.notify_all();
}

void StatusFeed::close() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !looking_; });
  if (newest_.number > 0) look(lock);  // somebody has been looking
  closed_ = true;
  changed_.notify_all();
}

bool StatusFeed::is_closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

}  // namespace penumbra
