// A TOML file as tables of values with their locations, limited to what a scene needs.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "scenes/diagnostic.h"

namespace penumbra::tinyrender {

/// A value of a type that no scene uses, described for messages: "a date", "an array of text".
struct OtherValue {
  std::string what;
};

using Value = std::variant<std::int64_t, double, bool, std::string, std::vector<double>, OtherValue>;

/// The type of a value in words: "an integer", "a number", "true or false", "text", "an array of numbers", or
/// the text of an OtherValue.
std::string describe_kind(const Value& value);

struct Entry {
  std::string key;
  Value value;
  std::string text;  ///< the value as text for settings; the numbers of an array are separated by blanks
  SourceLocation key_location;
  SourceLocation value_location;
};

struct Table {
  std::string name;
  SourceLocation location;
  std::vector<Entry> entries;  ///< in the order of the file
};

struct Document {
  std::vector<Table> tables;   ///< top-level tables, in the order of the file
  std::vector<Entry> entries;  ///< outside all tables, in the order of the file
};

/// Parses `file`. A syntax error is reported and ends reading.
Document read_document(const SourceFile& file, Diagnostics& diagnostics);

}  // namespace penumbra::tinyrender
