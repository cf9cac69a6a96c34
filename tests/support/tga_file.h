// Makes uncompressed 8-bit TGA images without any library.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace penumbra {

/// Rows from the top; 1 channel (grey), 3 (red, green, blue) or 4 (and alpha).
inline std::string tga_file(int width, int height, int channels, std::span<const std::uint8_t> values) {
  std::string file(18, '\0');
  file[2] = channels == 1 ? 3 : 2;
  for (int k = 0; k < 2; ++k) {
    file[std::size_t(12 + k)] = char(width >> 8 * k & 255);
    file[std::size_t(14 + k)] = char(height >> 8 * k & 255);
  }
  file[16] = char(8 * channels);
  file[17] = char(0x20 | (channels == 4 ? 8 : 0));  // from the top left
  for (std::size_t i = 0; i < values.size(); i += std::size_t(channels))
    for (int c = 0; c < channels; ++c) {
      const int from = channels == 1 || c == 3 ? c : 2 - c;  // blue, green, red
      file += char(values[i + std::size_t(from)]);
    }
  // The footer, without which Mitsuba does not know the format.
  return file + std::string(8, '\0') + std::string("TRUEVISION-XFILE.", 18);
}

}  // namespace penumbra
