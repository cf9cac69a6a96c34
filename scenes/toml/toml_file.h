// A TOML file and the locations of its values.
#pragma once

#include <toml++/toml.h>
#include <optional>
#include <utility>
#include <vector>

#include "scenes/diagnostic.h"

namespace penumbra {

/// The location of a line and column of the parser. A position that is not in the file gives the file's
/// start.
SourceLocation toml_location(const SourceFile& file, toml::source_position position);

/// The entries of a table in the order of the file.
std::vector<std::pair<const toml::key*, const toml::node*>> in_order(const toml::table& table);

/// Parses the file. Nothing, and an error with its location, if it is not TOML.
std::optional<toml::table> parse_toml(const SourceFile& file, Diagnostics& diagnostics);

}  // namespace penumbra
