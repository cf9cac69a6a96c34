#include "scheduler/watch/watch_board.h"

#include <algorithm>
#include <utility>

namespace penumbra {
namespace {

constexpr std::size_t kMessagesKept = 100;

}  // namespace

void WatchBoard::describe(WatchedJob job) {
  {
    const std::lock_guard lock(mutex_);
    job_ = std::move(job);
  }
  changed_.notify_all();
}

void WatchBoard::show_view(const WatchView& view) {
  {
    const std::lock_guard lock(mutex_);
    view_ = view;
    view_version_ = ++version_;
    progress_.reset();
    for (Tile& tile : tiles_) tile = {};
  }
  changed_.notify_all();
}

void WatchBoard::show_tile(std::uint32_t tile, TileSnapshot snapshot) {
  auto shared = std::make_shared<const TileSnapshot>(std::move(snapshot));
  {
    const std::lock_guard lock(mutex_);
    if (watchers_.empty()) return;
    tiles_[tile] = {++version_, std::move(shared)};
  }
  changed_.notify_all();
}

void WatchBoard::show_progress(WatchProgress progress) {
  auto shared = std::make_shared<const WatchProgress>(std::move(progress));
  {
    const std::lock_guard lock(mutex_);
    progress_ = std::move(shared);
    progress_version_ = ++version_;
  }
  changed_.notify_all();
}

void WatchBoard::say(std::string message) {
  {
    const std::lock_guard lock(mutex_);
    messages_.push_back(std::move(message));
    if (messages_.size() > kMessagesKept) messages_.pop_front();
    ++messages_said_;
    ++version_;
  }
  changed_.notify_all();
}

bool WatchBoard::is_watched() const {
  const std::lock_guard lock(mutex_);
  return !watchers_.empty();
}

bool WatchBoard::take_request_for_all_tiles() {
  const std::lock_guard lock(mutex_);
  return std::exchange(all_tiles_requested_, false);
}

void WatchBoard::want_layers(const std::vector<std::string>& names) {
  const std::lock_guard lock(mutex_);
  if (!job_) return;
  for (const std::string& name : names)
    if (std::ranges::find(job_->layers, name) != job_->layers.end())
      all_tiles_requested_ |= wanted_layers_.insert(name).second;
}

std::set<std::string> WatchBoard::wanted_layers() const {
  const std::lock_guard lock(mutex_);
  return wanted_layers_;
}

void WatchBoard::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

void WatchBoard::wait_for_watchers(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  const auto all_seen = [this] {
    return std::ranges::all_of(watchers_, [](const Watcher* watcher) { return watcher->has_seen_all(); });
  };
  for (std::uint64_t taken = items_taken_ + 1; !all_seen() && taken != items_taken_;) {
    taken = items_taken_;
    seen_.wait_for(lock, patience, all_seen);
  }
}

WatchBoard::Watcher::Watcher(WatchBoard& board) : board_(board) {
  const std::lock_guard lock(board_.mutex_);
  seen_tiles_.resize(board_.tiles_.size());
  if (board_.watchers_.empty()) board_.all_tiles_requested_ = true;
  board_.watchers_.push_back(this);
  seen_messages_ = board_.messages_said_ - board_.messages_.size();
}

WatchBoard::Watcher::~Watcher() {
  {
    const std::lock_guard lock(board_.mutex_);
    std::erase(board_.watchers_, this);
    if (board_.watchers_.empty()) {
      for (Tile& tile : board_.tiles_) tile = {};
      board_.wanted_layers_.clear();
    }
  }
  board_.seen_.notify_all();
}

std::optional<WatchedJob> WatchBoard::Watcher::job(std::chrono::milliseconds patience) {
  std::unique_lock lock(board_.mutex_);
  board_.changed_.wait_for(lock, patience, [this] { return board_.job_ || board_.closed_; });
  return board_.job_;
}

std::optional<WatchItem> WatchBoard::Watcher::next(std::chrono::milliseconds patience) {
  std::optional<WatchItem> item;
  {
    std::unique_lock lock(board_.mutex_);
    board_.changed_.wait_for(lock, patience, [this] { return board_.closed_ || !has_seen_all(); });
    if (has_seen_all()) return {};
    item = take();
    if (item) {
      ++board_.items_taken_;
    } else {
      seen_ = board_.version_;
    }
  }
  board_.seen_.notify_all();
  return item;
}

std::optional<WatchItem> WatchBoard::Watcher::take() {
  if (seen_view_ != board_.view_version_) {
    seen_view_ = board_.view_version_;
    return board_.view_;
  }
  if (seen_messages_ != board_.messages_said_) {
    const std::uint64_t first_kept = board_.messages_said_ - board_.messages_.size();
    seen_messages_ = std::max(seen_messages_, first_kept);
    return board_.messages_[std::size_t(seen_messages_++ - first_kept)];
  }
  if (board_.progress_ != nullptr && seen_progress_ != board_.progress_version_) {
    seen_progress_ = board_.progress_version_;
    return board_.progress_;
  }
  for (std::size_t i = 0; i < seen_tiles_.size(); ++i) {
    const std::size_t tile = (next_tile_ + i) % seen_tiles_.size();
    const Tile& newest = board_.tiles_[tile];
    if (newest.snapshot == nullptr || newest.version == seen_tiles_[tile]) continue;
    seen_tiles_[tile] = newest.version;
    next_tile_ = tile + 1;
    return newest.snapshot;
  }
  return {};
}

bool WatchBoard::Watcher::at_end() const {
  const std::lock_guard lock(board_.mutex_);
  return board_.closed_ && has_seen_all();
}

}  // namespace penumbra
