// Full-screen use of the terminal.
#pragma once

#include <string>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// Shows whole screens of lines; the previous contents of the terminal are restored afterwards. Keys are read
/// immediately and not echoed.
class TerminalScreen {
 public:
  /// Error: stdin or stdout is not a terminal.
  static Expected<TerminalScreen> open();
  TerminalScreen(TerminalScreen&& other) noexcept;
  TerminalScreen& operator=(TerminalScreen&&) = delete;
  ~TerminalScreen();

  struct Size {
    int columns = 80, rows = 24;
  };
  /// The current size.
  [[nodiscard]] Size size() const;
  void show(const std::vector<std::string>& lines);
  /// The next key, waiting at most `milliseconds`; 0: none; -1: the terminal is gone.
  [[nodiscard]] int key(int milliseconds);

 private:
  TerminalScreen() = default;
  bool is_open_ = false;
};

}  // namespace penumbra
