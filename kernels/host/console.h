// All output of the programs to the console. Messages for users go to stderr and are dropped if they cannot
// be written. Answers go to stdout, and the program fails if they cannot be written.
#pragma once

#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

/// Must be called first in main. Opens descriptors 0 to 2 if they are closed, so that no file of the program
/// becomes one of them. Ignores SIGPIPE and SIGXFSZ: the failing write reports the same, and no image is
/// lost. `name` precedes the program's messages.
void begin_program(std::string_view name);

/// The exit code at the end of main: `code`, or 1 instead of 0 if an answer could not be written. Reports
/// that, unless the reader has closed the pipe.
[[nodiscard]] int end_program(int code);

/// Prints one or more lines for users to stderr; control characters are made visible. Thread-safe.
void print_message(std::string_view text) noexcept;
/// Prints the message after `NAME: error: `, unless it starts with a file position itself.
void print_error(const Error& error) noexcept;
/// Prints the text after `NAME: warning: `, unless it starts with a file position itself.
void print_warning(std::string_view text) noexcept;

/// Collects what is printed to stderr instead, from its construction to its destruction. One at a time.
class CapturedMessages {
 public:
  CapturedMessages();
  ~CapturedMessages();
  CapturedMessages(const CapturedMessages&) = delete;
  CapturedMessages& operator=(const CapturedMessages&) = delete;
  [[nodiscard]] std::string text() const;

 private:
  std::string text_;
};

/// Prints requested output to stdout.
void print_answer(std::string_view text);
/// Prints unrequested output to stdout, such as a render's summary. Write errors are ignored.
void print_remark(std::string_view text);

/// Redraws one line of the terminal on stderr; messages replace it.
void redraw_line(std::string_view text);
/// Clears that line, if there is one.
void clear_line();

/// The text with everything that a terminal would interpret made visible: control characters other than
/// newline and tab become \u001b, which JSON can read as well, and bytes that are not UTF-8 become \x9b.
std::string visible_text(std::string_view text);

}  // namespace penumbra
