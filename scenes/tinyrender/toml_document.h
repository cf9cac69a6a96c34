// A TOML file as tables of values with their places: all that a scene needs of TOML.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "scenes/diagnostic.h"

namespace penumbra::tinyrender {

/// What no scene has a use for, by its name for messages: "a date", "an array of text".
struct OtherValue {
  std::string what;
};

using Value = std::variant<std::int64_t, double, bool, std::string, std::vector<double>, OtherValue>;

/// "an integer", "a number", "true or false", "text", "an array of numbers", or what an OtherValue is.
std::string describe_kind(const Value& value);

struct Entry {
  std::string key;
  Value value;
  std::string text;  ///< the value as settings take it: numbers of an array with blanks between
  SourceLocation key_location;
  SourceLocation value_location;
};

struct Table {
  std::string name;
  SourceLocation location;
  std::vector<Entry> entries;  ///< in the file's order
};

struct Document {
  std::vector<Table> tables;   ///< of the top level, in the file's order
  std::vector<Entry> entries;  ///< outside all tables
};

/// Parses `file`. What is not TOML is reported, and ends the reading.
Document read_document(const SourceFile& file, Diagnostics& diagnostics);

}  // namespace penumbra::tinyrender
