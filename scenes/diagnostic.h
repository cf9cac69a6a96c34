// How a scene reader tells people what is wrong: `file:line:column: error: …`, the source line, a caret, and
// the nearest known name. Every reader reports through here, whatever its format.
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
  std::size_t column = 1;  ///< from 1, in characters
};

/// A text file in memory, kept as long as anything may be reported about it; its text must not change then.
struct SourceFile {
  std::filesystem::path path;  ///< as the user would write it
  std::string text;
  struct Mark {
    std::size_t offset;
    LineColumn place;
  };
  /// The start of each line, and places within long ones; filled in when the first place is looked up.
  mutable std::vector<Mark> marks = {};
};

/// A place in a source file; without a file, nowhere in particular.
struct SourceLocation {
  const SourceFile* file = nullptr;
  std::size_t offset = 0;  ///< in bytes
};

/// Where `location` is in its file; past its end, the end.
LineColumn line_and_column(SourceLocation location);

/// The place of a line and column; the nearest that the file has.
SourceLocation location_of(const SourceFile& file, LineColumn place);

/// "file:line:column".
std::string describe(SourceLocation location);

/// "file:line:column: severity: message", or without a file what follows; visible (see text.h), and
/// cut to a readable length.
std::string format_message(SourceLocation location, std::string_view severity, std::string_view message);

/// That, the source line and a caret under the place. Long lines are cut to the part around the caret.
std::string format_diagnostic(SourceLocation location, std::string_view severity, std::string_view message);

/// "a, b, c", or "none".
std::string list_names(std::span<const std::string> names);

/// The end of a message that a name is not one of those known, after what is wrong with it: "; did you mean
/// 'x'? It has: x, y" or ". It has: x, y", where `these` is "It has".
std::string known_names(std::string_view name, std::span<const std::string> known, std::string_view these);

/// Collects what a reader finds. An error does not stop the reading, so that several are shown at once; a
/// reader that has had any returns `error()` and no scene.
class Diagnostics {
 public:
  void error(SourceLocation location, std::string_view message);
  /// An error that has its place in its text already.
  void error_text(std::string text);
  void warn(SourceLocation location, std::string_view message);
  /// One that is the same wherever it is found: at the first place alone, with how often it was found.
  void warn_counted(SourceLocation location, std::string_view message);

  [[nodiscard]] bool failed() const { return !errors_.empty(); }
  /// There are so many errors that more would not be shown: a reader may stop here, and should.
  [[nodiscard]] bool full() const;
  /// The errors, each once and the first few of many. Only after `failed()`.
  [[nodiscard]] Error error() const;
  /// Each once; of very many the first, and a last one that says how many more there are.
  [[nodiscard]] std::vector<std::string> take_warnings();

 private:
  std::vector<std::string> errors_;
  std::vector<std::string> warnings_;
  std::size_t more_warnings_ = 0;
  struct Counted {
    std::size_t warning;  ///< index of the first
    std::size_t count;
  };
  std::map<std::string, Counted, std::less<>> counted_;  ///< by message
  std::set<std::string> seen_;  ///< an object that several others refer to is read for each of them
};

}  // namespace penumbra
