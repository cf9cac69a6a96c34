// The size of the messages in which a worker sends a large result.
#pragma once

#include <algorithm>
#include <cstddef>

#include "worker/protocol/unit_result.h"

namespace penumbra {

/// Begins small and grows while the connection takes messages at once, so that most results need one message.
/// It shrinks where a message takes long, so that the next sign of life is never far behind.
class PartSize {
 public:
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

  /// A message with so many bytes was written in this time.
  void wrote(std::size_t bytes, double seconds) {
    if (seconds > kLongSeconds)
      bytes_ = std::max(bytes_ / 2, kLeast);
    else if (bytes >= bytes_ && seconds < kShortSeconds)
      bytes_ = std::min(bytes_ * 2, kMostPartBytes);
  }

 private:
  static constexpr std::size_t kFirst = std::size_t(64) << 10, kLeast = std::size_t(16) << 10;
  static constexpr double kLongSeconds = 0.5, kShortSeconds = 0.05;
  std::size_t bytes_ = kFirst;
};

}  // namespace penumbra
