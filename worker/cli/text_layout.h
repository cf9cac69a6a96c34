// Wraps text to the width of the terminal.
#pragma once

#include <string>
#include <string_view>

namespace penumbra {

/// The number of columns of the help, and of all text if stdout is not a terminal.
constexpr int kTextColumns = 100;

/// The width of stdout's terminal, clamped to [60, 200]; kTextColumns if it is not a terminal.
int text_columns();

/// The number of columns that the text takes on a terminal: its number of characters.
int columns_of(std::string_view text);

/// Wraps `text` to lines of at most `columns`, except for longer words. The first line begins at column `at`,
/// after existing text; all others are indented by `indent` spaces. Line feeds in the text are kept. There is
/// no line feed at the end.
std::string wrapped(std::string_view text, int at, int indent, int columns);

/// Two columns: a name, indented by two spaces, and its description from column `indent` on. The description
/// begins in the same line if the name is short enough. Ends with a line feed.
std::string described(std::string_view name, std::string_view text, int indent, int columns);

}  // namespace penumbra
