#include "scenes/number.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace penumbra {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

/// The text for a message: shortened, and with control characters replaced.
std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string shown(text.substr(0, kLongest));
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  return fmt::format("'{}{}'", shown, text.size() > kLongest ? "…" : "");
}

/// from_chars takes no leading '+'.
std::string_view without_plus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+';
  return plus ? text.substr(1) : text;
}

}  // namespace

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

Expected<double> parse_number(std::string_view text) {
  const std::string_view token = without_plus(trim(text));
  double value = 0.0;
  const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (token.empty() || code == std::errc::invalid_argument || end != token.data() + token.size()) {
    return fail(fmt::format("{} is not a number", quoted(text)));
  }
  if (code == std::errc::result_out_of_range) {
    // The standard does not say whether the number overflowed or underflowed. A negative exponent or leading
    // zeros tell.
    const std::size_t exponent = token.find_first_of("eE");
    const bool tiny = exponent == token.npos ? token.find_first_of("123456789") > token.find('.')
                                             : token.substr(exponent + 1).starts_with('-');
    if (tiny) return 0.0;
    return fail(fmt::format("{} is too large for a number", quoted(text)));
  }
  if (!std::isfinite(value)) return fail(fmt::format("{} is not a finite number", quoted(text)));
  return value;
}

Expected<std::int64_t> parse_integer(std::string_view text, std::int64_t low, std::int64_t high) {
  const std::string_view token = without_plus(trim(text));
  std::int64_t value = 0;
  const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (token.empty() || code == std::errc::invalid_argument || end != token.data() + token.size()) {
    return fail(fmt::format("{} is not an integer", quoted(text)));
  }
  if (code == std::errc::result_out_of_range || value < low || value > high) {
    return fail(fmt::format("{} is not in the range from {} to {}", quoted(text), low, high));
  }
  return value;
}

Expected<bool> parse_boolean(std::string_view text) {
  std::string token(trim(text));
  std::transform(token.begin(), token.end(), token.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (token == "true") return true;
  if (token == "false") return false;
  return fail(fmt::format("{} is neither true nor false", quoted(text)));
}

Expected<std::vector<std::string_view>> split_list(std::string_view text) {
  std::vector<std::string_view> tokens;
  std::size_t at = 0;
  bool after_comma = true;  // a comma is wrong at the start, after another, and at the end
  const auto skip_space = [&] {
    while (at < text.size() && is_space(text[at])) ++at;
  };
  for (skip_space(); at < text.size(); skip_space()) {
    if (text[at] == ',') {
      if (after_comma) return fail(fmt::format("{} has a comma without a value before it", quoted(text)));
      after_comma = true;
      ++at;
      continue;
    }
    const std::size_t start = at;
    while (at < text.size() && !is_space(text[at]) && text[at] != ',') ++at;
    tokens.push_back(text.substr(start, at - start));
    after_comma = false;
  }
  if (after_comma && !tokens.empty()) return fail(fmt::format("{} ends with a comma", quoted(text)));
  return tokens;
}

Expected<std::vector<double>> parse_numbers(std::string_view text) {
  const auto tokens = split_list(text);
  if (!tokens) return std::unexpected(tokens.error());
  std::vector<double> values;
  values.reserve(tokens->size());
  for (const std::string_view token : *tokens) {
    const auto value = parse_number(token);
    if (!value) return std::unexpected(value.error());
    values.push_back(*value);
  }
  return values;
}

}  // namespace penumbra
