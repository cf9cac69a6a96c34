// How a source of jobs, from any of its threads, gets the farm to look at it at once.
#pragma once

#include <functional>
#include <mutex>
#include <utility>

namespace penumbra {

class FarmBell {
 public:
  /// There is a job, or none will come any more. Nothing happens while no farm listens.
  void ring() {
    const std::lock_guard lock(mutex_);
    if (on_ring_) on_ring_();
  }
  /// Of the farm; called with nothing it returns when the last ring is over.
  void connect(std::function<void()> on_ring) {
    const std::lock_guard lock(mutex_);
    on_ring_ = std::move(on_ring);
  }

 private:
  std::mutex mutex_;
  std::function<void()> on_ring_;
};

}  // namespace penumbra
