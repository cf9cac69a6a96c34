#include "scenes/toml/toml_keys.h"

namespace penumbra {
namespace {

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

}  // namespace

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

}  // namespace penumbra
