// Writes 8-bit PNG images.
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace penumbra {

/// Rows from the top; 1 channel (grey), 3 (red, green, blue) or 4 (and alpha). The format is that of ISO
/// 15948.
inline std::string png_file(int width, int height, int channels, std::span<const std::uint8_t> values) {
  const auto big_endian = [](std::uint64_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += char(value >> shift & 255);
    return bytes;
  };
  const auto bytes_of = [](const std::string& text) { return reinterpret_cast<const Bytef*>(text.data()); };
  const auto chunk = [&](std::string_view type, const std::string& data) {
    const std::string body = std::string(type) + data;
    return big_endian(data.size()) + body + big_endian(crc32(0, bytes_of(body), uInt(body.size())));
  };
  const std::size_t row = std::size_t(width) * std::size_t(channels);
  std::string raw;
  for (int y = 0; y < height; ++y) {
    raw += '\0';  // no filter
    for (std::size_t i = 0; i < row; ++i) raw += char(values[std::size_t(y) * row + i]);
  }
  uLongf size = compressBound(uLong(raw.size()));
  std::string packed(size, '\0');
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &size, bytes_of(raw), uLong(raw.size())), Z_OK);
  packed.resize(size);
  const char kind = channels == 1 ? 0 : channels == 3 ? 2 : 6;
  const std::string header =
      big_endian(std::uint64_t(width)) + big_endian(std::uint64_t(height)) + std::string{8, kind, 0, 0, 0};
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", packed) + chunk("IEND", "");
}

}  // namespace penumbra
