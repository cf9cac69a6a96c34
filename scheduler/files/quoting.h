// Quotes text chosen by users (names of files, scenes, methods, settings) for other languages. Quoted text is
// never executed, expanded or interpreted as markup.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace penumbra {

/// A word for a POSIX shell, in single quotes if it contains special characters.
std::string shell_quoted(const std::string& word);

/// A file name as a word for a shell, which no program mistakes for an option.
std::string shell_quoted_file(const std::string& path);

/// A command line for a shell; the first word is the program.
std::string shell_command(std::span<const std::string> words);

/// Replaces <, >, &, " and ' by entities, for HTML text and quoted attributes.
std::string html_escaped(std::string_view text);

/// Text for LaTeX, in which nothing is a command and no two characters join. Control characters become
/// spaces.
std::string latex_escaped(std::string_view text);

/// A gnuplot string in single quotes, in which nothing is evaluated. Line ends and other control characters,
/// which would end it, become spaces. Terminals must be `noenhanced`.
std::string gnuplot_quoted(std::string_view text);

/// A text field for CSV (RFC 4180). A text that spreadsheets would take for a formula gets a leading
/// apostrophe.
std::string csv_quoted(const std::string& text);

/// A line of CSV; fields that need it must be quoted already.
std::string csv_line(std::span<const std::string> fields);

/// A file name for a text: control characters, '/' and '%' become %XX, so different texts have different
/// names.
std::string file_name_of(std::string_view text);

}  // namespace penumbra
