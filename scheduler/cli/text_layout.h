// Text for a terminal: lines that fit.
#pragma once

#include <string>
#include <string_view>

namespace penumbra {

/// Columns of the help, and of all text where stdout is no terminal.
constexpr int kTextColumns = 100;

/// Of the terminal that stdout is, within [60, 200]; kTextColumns where it is none.
int text_columns();

/// Columns that a terminal shows the text in: its characters.
int columns_of(std::string_view text);

/// The words of `text` in lines of at most `columns`, but for longer words. The first line begins at column
/// `at`, after what is there already, all others after `indent` spaces. Line feeds stay. No line feed at the
/// end.
std::string wrapped(std::string_view text, int at, int indent, int columns);

/// Two columns: a name, indented by two spaces, and what there is to say of it, from column `indent` on: in
/// the same line where the name is short enough. Ends in a line feed.
std::string described(std::string_view name, std::string_view text, int indent, int columns);

/// "512 B", "1.2 MB": in powers of 1000.
std::string size_text(double bytes);

}  // namespace penumbra
