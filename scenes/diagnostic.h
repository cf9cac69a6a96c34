// The messages of scene readers: `file:line:column: error: …`, the source line, a caret under the location,
// and the nearest known name. The readers of all formats report through this file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "kernels/host/text.h"

namespace penumbra {

struct LineColumn {
  std::size_t line = 1;    ///< from 1
  std::size_t column = 1;  ///< from 1, in characters, not bytes
};

/// A text file in memory. It must outlive every message about it, and its text must not change meanwhile.
struct SourceFile {
  std::filesystem::path path;  ///< as the user would write it
  std::string text;
  struct Mark {
    std::size_t offset;
    LineColumn place;
  };
  /// The offsets of line starts, and of some positions within long lines. Filled at the first look-up.
  mutable std::vector<Mark> marks = {};
};

/// A location in a source file. Without a file the location is unknown.
struct SourceLocation {
  const SourceFile* file = nullptr;
  std::size_t offset = 0;  ///< in bytes
};

/// Line and column of `location`. An offset past the end gives the end of the file.
LineColumn line_and_column(SourceLocation location);

/// The location of a line and column, or the nearest that exists in the file.
SourceLocation location_of(const SourceFile& file, LineColumn place);

/// "file:line:column".
std::string describe(SourceLocation location);

/// "file:line:column: severity: message"; without a file the part "file:line:column: " is left out. Control
/// characters are made visible (see text.h), and a long message is shortened.
std::string format_message(SourceLocation location, std::string_view severity, std::string_view message);

/// format_message, followed by the source line and a caret under the location. Of a long line only the part
/// around the caret is shown.
std::string format_diagnostic(SourceLocation location, std::string_view severity, std::string_view message);

/// "a, b, c", or "none".
std::string list_names(std::span<const std::string> names);

/// The end of a message about an unknown name: "; did you mean 'x'? It has: x, y", or ". It has: x, y" if no
/// known name is similar. `these` is "It has" here.
std::string known_names(std::string_view name, std::span<const std::string> known, std::string_view these);

/// Collects the errors and warnings of a reader. Reading goes on after an error, so that several are reported
/// at once. A reader with any errors returns `error()` and no scene.
class Diagnostics {
 public:
  void error(SourceLocation location, std::string_view message);
  /// Adds an error whose text already contains its location.
  void error_text(std::string text);
  void warn(SourceLocation location, std::string_view message);
  /// Adds a warning that may occur many times. It is shown once, at its first location, with the number of
  /// times that it occurred.
  void warn_counted(SourceLocation location, std::string_view message);

  [[nodiscard]] bool failed() const { return !errors_.empty(); }
  /// True when there are so many errors that further ones would not be shown. A reader should then stop.
  [[nodiscard]] bool full() const;
  /// The errors without duplicates; of many only the first few. Call it only after `failed()`.
  [[nodiscard]] Error error() const;
  /// The warnings without duplicates. If there are very many, only the first are returned, and the last
  /// element says how many were left out.
  [[nodiscard]] std::vector<std::string> take_warnings();

 private:
  std::vector<std::string> errors_;
  std::vector<std::string> warnings_;
  std::size_t more_warnings_ = 0;
  struct Counted {
    std::size_t warning;  ///< index of its first occurrence in the list of warnings
    std::size_t count;
  };
  std::map<std::string, Counted, std::less<>> counted_;  ///< keyed by message
  /// For removing duplicates: an object is read again for every reference to it.
  std::set<std::string> seen_;
};

}  // namespace penumbra
