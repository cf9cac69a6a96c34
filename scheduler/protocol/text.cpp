#include "scheduler/protocol/text.h"

#include <algorithm>

namespace penumbra {
namespace {

constexpr std::string_view kCut = "...";

/// Bytes of the valid UTF-8 character at the beginning; 0 if there is none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80 ? 1 : first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  if (length == 0 || first >= 0xf5 || length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  if (length <= 2) return length;
  // Forms that are longer than they need be, halves of surrogate pairs, and what is beyond Unicode.
  const unsigned second = byte(1);
  const bool is_wrong = (first == 0xe0 && second < 0xa0) || (first == 0xed && second >= 0xa0) ||
                        (first == 0xf0 && second < 0x90) || (first == 0xf4 && second >= 0x90);
  return is_wrong ? 0 : length;
}

}  // namespace

std::string wire_text(std::string_view text, std::size_t longest) {
  std::string valid;
  valid.reserve(std::min(text.size(), longest));
  std::size_t cut = 0;  // where the text may end to leave room for the mark
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = character_length(text.substr(at));
    const std::size_t size = std::max<std::size_t>(length, 1);
    if (valid.size() + size > longest) return valid.substr(0, cut).append(kCut);
    valid += length > 0 ? text.substr(at, length) : "?";
    if (valid.size() + kCut.size() <= longest) cut = valid.size();
    at += size;
  }
  return valid;
}

}  // namespace penumbra
