// Lets a source of jobs, from any thread, make the farm ask it for jobs at once.
#pragma once

#include <functional>
#include <mutex>
#include <utility>

namespace penumbra {

class JobSignal {
 public:
  /// There is a new job, or there will be no more. Does nothing while no farm is connected.
  void notify() {
    const std::lock_guard lock(mutex_);
    if (on_notify_) on_notify_();
  }
  /// For the farm: sets the callback. Called with an empty function, it returns when the last callback has
  /// ended.
  void connect(std::function<void()> on_notify) {
    const std::lock_guard lock(mutex_);
    on_notify_ = std::move(on_notify);
  }

 private:
  std::mutex mutex_;
  std::function<void()> on_notify_;
};

}  // namespace penumbra
