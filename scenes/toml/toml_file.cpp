#include "scenes/toml/toml_file.h"

#include <algorithm>

#include <fmt/format.h>

#include "scenes/toml/toml_keys.h"

namespace penumbra {

/// The parser's lines and columns begin at 1, columns in code points. 0 means unknown.
SourceLocation toml_location(const SourceFile& file, toml::source_position position) {
  if (position.line == 0 || position.column == 0) return {&file, 0};
  return location_of(file, {position.line, position.column});
}

std::optional<toml::table> parse_toml(const SourceFile& file, Diagnostics& diagnostics) {
  // The parser limits the nesting of arrays and inline tables, but not that of dotted keys, which may
  // overflow the stack.
  if (const auto deep = find_deep_key(file.text)) {
    diagnostics.error({&file, *deep}, fmt::format("a key of more than {} parts", kMaxKeyParts));
    return std::nullopt;
  }
  try {
    return toml::parse(std::string_view(file.text));
  } catch (const toml::parse_error& error) {
    diagnostics.error(toml_location(file, error.source().begin),
                      fmt::format("not TOML: {}", error.description()));
    return std::nullopt;
  }
}

std::vector<std::pair<const toml::key*, const toml::node*>> in_order(const toml::table& table) {
  std::vector<std::pair<const toml::key*, const toml::node*>> entries;
  for (auto&& [key, node] : table) entries.emplace_back(&key, &node);
  std::ranges::sort(entries, [](const auto& a, const auto& b) {
    const toml::source_position x = a.first->source().begin, y = b.first->source().begin;
    return std::pair(x.line, x.column) < std::pair(y.line, y.column);
  });
  return entries;
}

}  // namespace penumbra
