// A closable queue of bounded length between threads.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <limits>
#include <mutex>
#include <optional>
#include <queue>
#include <utility>

namespace penumbra {

template <typename T>
class Mailbox {
 public:
  explicit Mailbox(std::size_t most = std::numeric_limits<std::size_t>::max()) : most_(most) {}

  /// Waits while the queue is full. An item for a closed queue is dropped.
  void put(T item) {
    {
      std::unique_lock lock(mutex_);
      has_room_.wait(lock, [this] { return closed_ || items_.size() < most_; });
      if (closed_) return;
      items_.push(std::move(item));
    }
    changed_.notify_one();
  }

  /// No more items are accepted. Those in the queue can still be taken.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
    has_room_.notify_all();
  }

  /// Waits for the next item. Returns nothing once the queue is closed and empty.
  std::optional<T> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !items_.empty(); });
    return take_first();
  }

  /// The same, waiting at most `patience`.
  std::optional<T> take(std::chrono::milliseconds patience) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, patience, [this] { return closed_ || !items_.empty(); });
    return take_first();
  }

 private:
  std::optional<T> take_first() {
    if (items_.empty()) return {};
    T first = std::move(items_.front());
    items_.pop();
    has_room_.notify_one();
    return first;
  }

  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable changed_, has_room_;
  std::queue<T> items_;
  bool closed_ = false;
};

}  // namespace penumbra
