#include "scenes/toml/toml_file.h"

#include <algorithm>

#include <fmt/format.h>

namespace penumbra {
namespace {

/// The largest number of parts of a dotted key. Each part is a table inside the one before it.
constexpr int kMaxKeyParts = 8;

/// The offset after the string or comment that begins at `at`; `at` if none begins there.
std::size_t skip(std::string_view text, std::size_t at) {
  const char quote = text[at];
  if (quote == '#') return text.find('\n', at);
  if (quote != '"' && quote != '\'') return at;
  const bool escapes = quote == '"';
  const bool several_lines = text.substr(at, 3) == (escapes ? "\"\"\"" : "'''");
  const std::size_t length = several_lines ? 3 : 1;
  const std::string_view end = text.substr(at, length);
  for (at += length; at < text.size(); ++at) {
    if (escapes && text[at] == '\\') {
      ++at;
    } else if (text.substr(at, length) == end) {
      at += length;
      // Up to two quotes may precede the three that end the string.
      while (several_lines && at < text.size() && text[at] == quote) ++at;
      return at;
    } else if (text[at] == '\n' && !several_lines) {
      return at;
    }
  }
  return text.npos;
}

/// The offset of the first dotted key, of a value or a table, with more than kMaxKeyParts parts. Malformed
/// text is scanned up to the error.
std::optional<std::size_t> find_deep_key(std::string_view text) {
  constexpr std::string_view kBetweenKeys = "=,[]{}\n", kBlanks = " \t\r";
  int parts = 1;
  std::size_t begin = text.npos;  // of the key, or of a value, which never has two dots
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (kBetweenKeys.find(c) != kBetweenKeys.npos) {
      parts = 1;
      begin = text.npos;
    } else if (kBlanks.find(c) == kBlanks.npos) {
      if (begin == text.npos) begin = at;
      if (c == '.' && ++parts > kMaxKeyParts) return begin;
    }
    const std::size_t after = skip(text, at);
    at = after == at ? at + 1 : after;
  }
  return std::nullopt;
}

}  // namespace

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
