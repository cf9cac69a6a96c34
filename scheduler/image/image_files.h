// Image files as bytes. What is written depends on the image alone: no time, host or process id gets in, so
// equal images give equal files.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// OpenEXR: all channels as 32-bit floats, ZIP compression, data and display window, every metadata entry.
Expected<std::vector<std::uint8_t>> encode_exr(const Image& image);

/// PNG: the beauty layer of the data window through `display_byte`, 8 bits a channel, no alpha.
Expected<std::vector<std::uint8_t>> encode_png(const Image& image);

/// PNG of pixels that are ready for the display: sRGB, 8 bits of red, green and blue, row by row from the
/// top. An error if there are not width × height of them.
Expected<std::vector<std::uint8_t>> encode_png_bytes(int width, int height,
                                                     std::span<const std::uint8_t> pixels);

}  // namespace penumbra
