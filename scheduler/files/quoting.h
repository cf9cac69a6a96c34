// Text that users choose (names of files, scenes, methods, settings), written into the languages of others:
// there it stays text, and nothing in it is run, expanded or taken for markup.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace penumbra {

/// One word of a POSIX shell; in single quotes if it would read anything in it as special.
std::string shell_quoted(const std::string& word);

/// A file as a word of a shell's command, which no program takes for an option.
std::string shell_quoted_file(const std::string& path);

/// The words of a command, the first of them the program, as a line for a shell.
std::string shell_command(std::span<const std::string> words);

/// <, >, &, " and ' as entities: for HTML, also inside attributes in quotes.
std::string html_escaped(std::string_view text);

/// A string of gnuplot in single quotes, in which it evaluates nothing; line ends and other control
/// characters, which would end it, become spaces. Terminals have to be `noenhanced`.
std::string gnuplot_quoted(std::string_view text);

/// A text field of RFC 4180. One that spreadsheets would take for a formula has an apostrophe before it.
std::string csv_quoted(const std::string& text);

/// A name for a file in a folder of ours: control characters, '/' and '%' as %XX, so different texts have
/// different names.
std::string file_name_of(std::string_view text);

}  // namespace penumbra
