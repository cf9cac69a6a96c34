// Shows a render in tev while it progresses.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "scheduler/watch/tev.h"
#include "scheduler/watch/watch_board.h"

namespace penumbra {

/// A viewer with a thread of its own that forwards what the board shows to tev. The image shows the whole
/// film and has the job's name. Its channels are R, G, B and, for hybrid jobs, difference.R, .G, .B and
/// standard_error.Y. Another view starts it again. A slow tev delays neither the render nor other viewers. If
/// tev is missing, hangs or goes away, the stream ends with one problem to report.
class TevStream {
 public:
  /// `address`: see parse_tev_address. The stream ends by itself once the board is closed and tev has
  /// received everything.
  TevStream(WatchBoard& board, std::string address, std::chrono::milliseconds timeout = kTevTimeout);
  TevStream(const TevStream&) = delete;
  TevStream& operator=(const TevStream&) = delete;
  ~TevStream();

  /// Ends the stream now, even if tev has not received everything.
  void stop();
  /// The problem, for the user; returned once.
  [[nodiscard]] std::optional<std::string> take_problem();

 private:
  void run(const std::stop_token& stop);
  Expected<void> stream(const std::stop_token& stop);

  const std::string address_;
  const std::chrono::milliseconds timeout_;
  std::optional<WatchBoard::Watcher> watcher_;  // created by the thread

  std::mutex mutex_;
  std::optional<std::string> problem_;

  std::jthread thread_;
};

}  // namespace penumbra
