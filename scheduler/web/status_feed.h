// The state as browsers receive it: one text for all of them, made only while somebody waits for it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace penumbra {

/// Thread-safe. The waiting threads themselves look for changes, one at a time.
class StatusFeed {
 public:
  /// `status` is called at most once per `interval`, and so seldom that it takes at most 5% of the time.
  explicit StatusFeed(std::function<nlohmann::ordered_json()> status,
                      std::chrono::milliseconds interval = std::chrono::milliseconds(500));

  struct State {
    std::uint64_t number = 0;  ///< increases with every change
    std::shared_ptr<const std::string> json;
  };
  /// The newest state if it differs from the one of this number (0: none has been seen), waiting at most
  /// `patience`. What changes by itself, such as the time of day, is no difference.
  std::optional<State> next(std::uint64_t seen, std::chrono::milliseconds patience);
  /// Looks a last time. From now on next() returns at once: that state, or nothing.
  void close();
  [[nodiscard]] bool is_closed() const;

 private:
  using Clock = std::chrono::steady_clock;

  void look(std::unique_lock<std::mutex>& lock);

  const std::function<nlohmann::ordered_json()> status_;
  const std::chrono::milliseconds interval_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  State newest_;
  nlohmann::ordered_json compared_;  // the newest state without what changes by itself
  Clock::time_point next_look_{};
  bool looking_ = false, closed_ = false;
};

}  // namespace penumbra
