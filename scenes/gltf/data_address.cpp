#include "scenes/gltf/data_address.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cstdint>

namespace penumbra::gltf {
namespace {

constexpr std::string_view kScheme = "data:";

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// The six bits of each digit, for both alphabets of RFC 4648; -1 for other characters.
constexpr std::array<std::int8_t, 256> base64_digits() {
  std::array<std::int8_t, 256> digits{};
  digits.fill(-1);
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kDigits.size(); ++i) digits[std::uint8_t(kDigits[i])] = std::int8_t(i);
  digits['-'] = 62;
  digits['_'] = 63;
  return digits;
}

Expected<std::string> from_base64(std::string_view text) {
  static constexpr std::array<std::int8_t, 256> kDigits = base64_digits();
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    if (c == '\n' || c == '\r' || c == ' ' || c == '\t') continue;
    const int digit = kDigits[std::uint8_t(c)];
    if (digit < 0) return fail("its data are not base64");
    word = word << 6 | std::uint32_t(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += char(std::uint8_t(word >> bits));
  }
  return bytes;
}

}  // namespace

bool is_data_address(std::string_view address) {
  if (address.size() < kScheme.size()) return false;
  for (std::size_t i = 0; i < kScheme.size(); ++i)
    if (std::tolower(static_cast<unsigned char>(address[i])) != kScheme[i]) return false;
  return true;
}

Expected<std::string> data_of_address(std::string_view address) {
  const std::size_t comma = address.find(',');
  if (comma == address.npos) return fail("an address of data has a comma before them");
  const std::string_view type = address.substr(0, comma), data = address.substr(comma + 1);
  if (!type.ends_with(";base64")) return percent_decoded(data);
  return data.contains('%') ? from_base64(percent_decoded(data)) : from_base64(data);
}

std::string percent_decoded(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(text[i + 2]) : -1;
    if (low < 0) {
      result += text[i];
      continue;
    }
    result += char(16 * high + low);
    i += 2;
  }
  return result;
}

}  // namespace penumbra::gltf
