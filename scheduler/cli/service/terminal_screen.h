// A terminal that one program has to itself for a while.
#pragma once

#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// Whole screens of lines; what was on the terminal before is there again afterwards. Keys come at once,
/// unechoed.
class TerminalScreen {
 public:
  /// Error: stdin and stdout are no terminal.
  static Expected<TerminalScreen> open();
  TerminalScreen(TerminalScreen&& other) noexcept;
  TerminalScreen& operator=(TerminalScreen&&) = delete;
  ~TerminalScreen();

  struct Size {
    int columns = 80, rows = 24;
  };
  /// At the moment.
  [[nodiscard]] Size size() const;
  void show(const std::vector<std::string>& lines);
  /// The next key, waiting for it at most so long; 0: none, -1: the terminal is gone.
  [[nodiscard]] int key(int milliseconds);

 private:
  TerminalScreen() = default;
  bool is_open_ = false;
};

}  // namespace penumbra
