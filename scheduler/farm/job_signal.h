// How a source of jobs, from any of its threads, gets the farm to look at it at once.
#pragma once

#include <functional>
#include <mutex>
#include <utility>

namespace penumbra {

class JobSignal {
 public:
  /// There is a job, or none will come any more. Nothing happens while no farm listens.
  void notify() {
    const std::lock_guard lock(mutex_);
    if (on_notify_) on_notify_();
  }
  /// Of the farm; called with nothing it returns when the last call is over.
  void connect(std::function<void()> on_notify) {
    const std::lock_guard lock(mutex_);
    on_notify_ = std::move(on_notify);
  }

 private:
  std::mutex mutex_;
  std::function<void()> on_notify_;
};

}  // namespace penumbra
