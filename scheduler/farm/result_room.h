// Bounds the memory for results that arrive in parts.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>

namespace penumbra {

/// Results take their room when they begin, so each one that has begun can be completed. Thread-safe.
class ResultRoom {
 public:
  /// `bytes`: for all results at a time. A larger one gets room when there is no other.
  explicit ResultRoom(std::size_t bytes) : state_(std::make_shared<State>(bytes)) {}

  /// Room for as long as the returned object exists; null if there is none now.
  [[nodiscard]] std::shared_ptr<void> take(std::size_t bytes);

 private:
  struct State {
    explicit State(std::size_t all) : most(all) {}
    const std::size_t most;
    std::mutex mutex;
    std::size_t used = 0;
  };
  const std::shared_ptr<State> state_;  // also of rooms that outlive this
};

}  // namespace penumbra
