// All that the programs print goes through here: messages for people to stderr, where one that cannot be
// written is dropped, and answers to stdout, where one that cannot be written makes the program fail.
#pragma once

#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra {

/// The first call of main. Opens descriptors 0 to 2 where they are closed, so that no file of ours becomes
/// one of them, and ignores the signals of a reader that went away and of a file that grew too large: the
/// write that fails says the same, and an image is not lost for it. `name` begins the program's messages.
void begin_program(std::string_view name);

/// The exit code at the end of main: `code`, or 1 instead of 0 where an answer could not be written. Says so,
/// unless it is the reader that went away.
[[nodiscard]] int end_program(int code);

/// A line or more for people, on stderr, as it is but for control characters. Any thread may call it.
void print_message(std::string_view text) noexcept;
/// The message after `NAME: error: `, unless it names a place in a file itself.
void print_error(const Error& error) noexcept;
/// The text after `NAME: warning: `, unless it names a place in a file itself.
void print_warning(std::string_view text) noexcept;

/// What was asked for, on stdout.
void print_answer(std::string_view text);
/// Output that was not requested, on stdout: a render's summary. A failure to write it is ignored.
void print_remark(std::string_view text);

/// Redraws one line of stderr's terminal; messages take its place.
void redraw_line(std::string_view text);
/// Clears it, if there is one.
void clear_line();

/// The text with what a terminal would obey made visible: control characters other than newline and tab as
/// \u001b, which JSON reads as well, and bytes that are no UTF-8 as \x9b.
std::string visible_text(std::string_view text);

}  // namespace penumbra
