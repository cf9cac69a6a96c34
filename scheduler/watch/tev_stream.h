// Shows a render in tev while it converges.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "scheduler/watch/tev.h"
#include "scheduler/watch/watch_board.h"

namespace penumbra {

/// A watcher with a thread of its own that passes on to tev what the board shows: an image of the whole film,
/// named after the job, with the channels R, G, B and, for hybrid jobs, difference.R, .G, .B and
/// standard_error.Y. Another view starts it over. A slow tev delays neither the render nor other
/// watchers. A tev that is missing, hangs or goes away ends the stream with one problem to report.
class TevStream {
 public:
  /// `address`: see parse_tev_address. Ends by itself once the board is closed and tev has everything.
  TevStream(WatchBoard& board, std::string address, std::chrono::milliseconds timeout = kTevTimeout);
  TevStream(const TevStream&) = delete;
  TevStream& operator=(const TevStream&) = delete;
  ~TevStream();

  /// Ends the stream now, whatever tev has.
  void stop();
  /// What went wrong, for people; once.
  [[nodiscard]] std::optional<std::string> take_problem();

 private:
  void run(const std::stop_token& stop);
  Expected<void> stream(const std::stop_token& stop);

  const std::string address_;
  const std::chrono::milliseconds timeout_;
  std::optional<WatchBoard::Watcher> watcher_;  // of the thread, once that is there

  std::mutex mutex_;
  std::optional<std::string> problem_;

  std::jthread thread_;
};

}  // namespace penumbra
