#include "scheduler/cli/service/terminal_screen.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>
#include <utility>

namespace penumbra {
namespace {

// ECMA-48 and xterm control sequences: alternate screen, hide cursor, cursor to the top, clear to the end of
// the line and of the screen.
constexpr std::string_view kEnter = "\x1b[?1049h\x1b[?25l", kLeave = "\x1b[?25h\x1b[?1049l", kHome = "\x1b[H",
                           kEndOfLine = "\x1b[K\r\n", kEndOfScreen = "\x1b[J";

termios before;  // settings of the terminal before it was changed

void put(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(STDOUT_FILENO, text.data(), text.size());
    if (written <= 0) return;
    text.remove_prefix(std::size_t(written));
  }
}

}  // namespace

Expected<TerminalScreen> TerminalScreen::open() {
  const char* kind = std::getenv("TERM");
  if (!isatty(STDIN_FILENO) || !isatty(STDOUT_FILENO) || kind == nullptr ||
      std::string_view(kind) == "dumb" || tcgetattr(STDIN_FILENO, &before) != 0)
    return fail("--watch needs a terminal; without it the state is printed once, with --json for programs");
  termios raw = before;
  raw.c_lflag &= ~tcflag_t(ICANON | ECHO);  // signals stay enabled, so Ctrl-C works as usual
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  put(kEnter);
  TerminalScreen screen;
  screen.is_open_ = true;
  return screen;
}

TerminalScreen::TerminalScreen(TerminalScreen&& other) noexcept
    : is_open_(std::exchange(other.is_open_, false)) {}

TerminalScreen::~TerminalScreen() {
  if (!is_open_) return;
  put(kLeave);
  tcsetattr(STDIN_FILENO, TCSANOW, &before);
}

TerminalScreen::Size TerminalScreen::size() const {
  winsize window{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col == 0 || window.ws_row == 0) return {};
  return {window.ws_col, window.ws_row};
}

void TerminalScreen::show(const std::vector<std::string>& lines) {
  std::string text(kHome);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += lines[i];
    // No newline after the last row, because it would scroll.
    text += i + 1 < lines.size() ? kEndOfLine : kEndOfLine.substr(0, kEndOfLine.size() - 2);
  }
  text += kEndOfScreen;
  put(text);
}

int TerminalScreen::key(int milliseconds) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (poll(&input, 1, milliseconds) <= 0) return 0;
  unsigned char byte = 0;
  const ssize_t count = read(STDIN_FILENO, &byte, 1);
  if (count == 1) return byte;
  return (input.revents & (POLLHUP | POLLERR)) != 0 || count < 0 ? -1 : 0;
}

}  // namespace penumbra
