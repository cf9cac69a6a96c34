// A closable queue between threads.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <queue>
#include <utility>

namespace penumbra {

template <typename T>
class Mailbox {
 public:
  void put(T item) {
    {
      const std::lock_guard lock(mutex_);
      items_.push(std::move(item));
    }
    changed_.notify_one();
  }

  /// Nothing more will come; what is in there can still be taken.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    changed_.notify_all();
  }

  /// Waits for the next item; nothing once the queue is closed and empty.
  std::optional<T> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !items_.empty(); });
    return take_first();
  }

  /// The same, but waits at most so long.
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
    return first;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::queue<T> items_;
  bool closed_ = false;
};

}  // namespace penumbra
