// A TOML file and the places of what is in it.
#pragma once

#include <toml++/toml.h>
#include <optional>
#include <utility>
#include <vector>

#include "scenes/diagnostic.h"

namespace penumbra {

/// Where something of the file is, from the parser's line and column; the file's start for what is nowhere.
SourceLocation toml_location(const SourceFile& file, toml::source_position position);

/// The entries of a table in the file's order.
std::vector<std::pair<const toml::key*, const toml::node*>> in_order(const toml::table& table);

/// Parses the file. Nothing, and an error at its place, for what is not TOML.
std::optional<toml::table> parse_toml(const SourceFile& file, Diagnostics& diagnostics);

}  // namespace penumbra
