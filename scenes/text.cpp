#include "scenes/text.h"

#include <fmt/format.h>

#include "kernels/host/text.h"

namespace penumbra {
namespace {

char32_t character_at(std::string_view text, std::size_t at, std::size_t length) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[at + k]); };
  if (length == 1) return byte(0);
  char32_t result = byte(0) & (0xFFu >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) result = result << 6 | (byte(k) & 0x3Fu);
  return result;
}

/// Characters that mislead readers: marks and overrides of the writing direction, line and paragraph
/// separators, zero-width characters.
bool misleads(char32_t c) {
  return (c >= 0x80 && c < 0xA0) || c == 0xAD || c == 0x61C || (c >= 0x200B && c <= 0x200F) ||
         (c >= 0x2028 && c <= 0x202E) || (c >= 0x2060 && c <= 0x206F) || c == 0xFEFF;
}

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

}  // namespace

std::string visible(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = character_length(text, at);
    if (length == 0) {
      result += kReplacement;
      ++at;
      continue;
    }
    const char32_t c = character_at(text, at, length);
    if ((c < 0x20 && c != '\t') || c == 0x7F) {
      result += "\xE2\x90";  // U+2400 and on
      result += static_cast<char>(c == 0x7F ? 0xA1u : 0x80u + c);
    } else if (misleads(c)) {
      result += kReplacement;
    } else {
      result += text.substr(at, length);
    }
    at += length;
  }
  return result;
}

std::string shortened(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return std::string(text);
  std::size_t end = bytes;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
  return fmt::format("{} … ({} bytes in all)", text.substr(0, end), text.size());
}

}  // namespace penumbra
