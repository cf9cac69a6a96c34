// Shows a render in the image viewer tev (https://github.com/Tom94/tev) while it progresses.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "kernels/host/error.h"
#include "scheduler/watch/watch_board.h"

namespace penumbra {

struct TevAddress {
  std::string host = "127.0.0.1", port = "14158";
};

/// Parses "HOST", "HOST:PORT", "[IPV6]:PORT", "IPV6", ":PORT" or an empty text. Missing parts are tev's
/// defaults.
Expected<TevAddress> parse_tev_address(std::string_view text);

/// Forwards what the board shows to tev, on a thread of its own. The image shows the whole film and has the
/// job's name. Its channels are R, G, B and, for hybrid jobs, difference.R, .G, .B and standard_error.Y. A
/// slow tev misses intermediate states of tiles, and delays neither the render nor other viewers. If tev is
/// missing, hangs or goes away, the stream ends with a problem.
class TevStream {
 public:
  /// The board must have its job. `timeout` applies to connecting, and to each wait until tev accepts more
  /// bytes. The stream ends once the board is closed and tev has received everything.
  TevStream(WatchBoard& board, std::string address,
            std::chrono::milliseconds timeout = std::chrono::seconds(5));

  /// Ends the stream now, even if tev has not received everything.
  void stop();
  /// The problem, for the user; returned once.
  [[nodiscard]] std::optional<std::string> take_problem();

 private:
  void run(const std::stop_token& stop);
  Expected<void> stream(const std::stop_token& stop);

  const std::string address_;
  const std::chrono::milliseconds timeout_;
  std::optional<WatchBoard::Watcher> watcher_;

  std::mutex mutex_;
  std::optional<std::string> problem_;

  std::jthread thread_;  // the last member, since it uses the others
};

}  // namespace penumbra
