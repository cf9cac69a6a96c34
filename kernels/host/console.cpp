#include "kernels/host/console.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <mutex>

#include "kernels/host/text.h"

namespace penumbra {
namespace {

constexpr std::string_view kClearLine = "\r\x1b[K";

struct Console {
  std::mutex mutex;
  std::string name = "penumbra";
  bool line_is_drawn = false;
  bool has_answered = false;
  std::string* captured = nullptr;  ///< takes messages in place of stderr
  int answer_error = 0;             ///< errno of the first answer that could not be written
};

/// Never destroyed: threads of libraries may print while the program ends.
Console& console() {
  static Console& the_one = *new Console;
  return the_one;
}

/// 0, or errno.
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(descriptor, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes.remove_prefix(std::size_t(written));
    } else if (errno == EAGAIN) {  // another process has made the shared terminal or pipe non-blocking
      pollfd ready{descriptor, POLLOUT, 0};
      if (poll(&ready, 1, -1) < 0 && errno != EINTR) return errno;
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

/// Writes to stderr, in place of a line that is drawn.
void write_message(std::string_view text) {
  Console& c = console();
  const std::lock_guard lock(c.mutex);
  if (c.captured != nullptr) {
    c.captured->append(text);
    return;
  }
  write_all(STDERR_FILENO, c.line_is_drawn ? std::string(kClearLine).append(text) : std::string(text));
  c.line_is_drawn = false;
}

/// Whether the first line reads `file:line:column: kind: …`.
bool names_its_place(std::string_view text, std::string_view kind) {
  const std::string_view first_line = text.substr(0, text.find('\n'));
  return first_line.find(fmt::format(": {}: ", kind)) != std::string_view::npos;
}

void print_kind(std::string_view text, std::string_view kind) noexcept {
  try {
    if (names_its_place(text, kind)) return print_message(text);
    if (text.starts_with(fmt::format("{}: ", kind))) text.remove_prefix(kind.size() + 2);
    print_message(fmt::format("{}: {}: {}", console().name, kind, text));
  } catch (const std::exception&) {  // out of memory
    print_message(text);
  }
}

}  // namespace

CapturedMessages::CapturedMessages() {
  const std::lock_guard lock(console().mutex);
  console().captured = &text_;
}

CapturedMessages::~CapturedMessages() {
  const std::lock_guard lock(console().mutex);
  console().captured = nullptr;
}

std::string CapturedMessages::text() const {
  const std::lock_guard lock(console().mutex);
  return text_;
}

void begin_program(std::string_view name) {
  console().name = name;
  // open() returns the lowest free descriptor, which is the closed one. It is opened for reading only, so
  // that writing to it fails.
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) (void)open("/dev/null", O_RDONLY);
  }
  for (const int ignored : {SIGPIPE, SIGXFSZ}) std::signal(ignored, SIG_IGN);
}

int end_program(int code) {
  clear_line();
  Console& c = console();
  // Some file systems report write errors only when the file is closed.
  if (c.has_answered && c.answer_error == 0 && close(dup(STDOUT_FILENO)) != 0) c.answer_error = errno;
  if (c.answer_error == 0) return code;
  if (c.answer_error != EPIPE)
    print_error({fmt::format("cannot write to standard output: {}",
                             c.answer_error == EBADF ? "it is closed" : std::strerror(c.answer_error))});
  return code == 0 ? 1 : code;
}

void print_message(std::string_view text) noexcept {
  try {
    write_message(visible_text(text) + "\n");
  } catch (const std::exception&) {  // out of memory: this message needs none
    constexpr std::string_view kNoMemory = "out of memory\n";
    write_all(STDERR_FILENO, kNoMemory);
  }
}

void print_error(const Error& error) noexcept { print_kind(error.message, "error"); }

void print_warning(std::string_view text) noexcept { print_kind(text, "warning"); }

void print_answer(std::string_view text) {
  clear_line();
  Console& c = console();
  const std::lock_guard lock(c.mutex);
  c.has_answered = true;
  if (c.answer_error == 0) c.answer_error = write_all(STDOUT_FILENO, visible_text(text));
}

void print_remark(std::string_view text) {
  clear_line();
  write_all(STDOUT_FILENO, visible_text(text));
}

void redraw_line(std::string_view text) {
  Console& c = console();
  const std::lock_guard lock(c.mutex);
  write_all(STDERR_FILENO, std::string(kClearLine) + visible_text(text));
  c.line_is_drawn = true;
}

void clear_line() { write_message(""); }

std::string visible_text(std::string_view text) {
  std::string visible;
  visible.reserve(text.size());
  while (!text.empty()) {
    const auto first = static_cast<unsigned char>(text.front());
    const std::size_t length = character_length(text, 0);
    const bool is_c0 = length == 1 && (first < 0x20 || first == 0x7F) && first != '\n' && first != '\t';
    const bool is_c1 = length == 2 && first == 0xC2 && static_cast<unsigned char>(text[1]) < 0xA0;
    if (length == 0) {
      visible += fmt::format("\\x{:02x}", first);
    } else if (is_c0 || is_c1) {
      visible += fmt::format("\\u{:04x}", static_cast<unsigned char>(text[length - 1]));
    } else {
      visible += text.substr(0, length);
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return visible;
}

}  // namespace penumbra
