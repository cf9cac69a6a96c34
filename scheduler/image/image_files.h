// Image files as bytes. What is written depends on the image alone: no time, host or process id gets in, so
// equal images give equal files.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/film_format.h"
#include "scheduler/image/image.h"

namespace penumbra {

struct ExrEncoding {
  ExrCompression compression = ExrCompression::kZip;
  bool half = false;  ///< 16 bits in channels that are good enough with them, see is_half_channel
};

/// Colours, alpha and normals: what is shown or guides. Not variances, distances and counts, of which 11
/// bits, or at most 65504, are too few.
bool is_half_channel(std::string_view name);

/// Values of those channels that are beyond the range of 16 bits: a file has the largest ones instead.
std::uint64_t values_beyond_half(const Image& image);

/// OpenEXR: all channels, by default as 32-bit floats with ZIP compression; data and display window, every
/// metadata entry, camera and chromaticities as its standard attributes. Exact channels have a part of their
/// own, with the metadata cryptomatte/…, where the compression would change floats.
Expected<std::vector<std::uint8_t>> encode_exr(const Image& image, const ExrEncoding& encoding = {});

/// PNG: the beauty layer of the data window through `display_byte`, 8 bits a channel. With a channel A it has
/// alpha, by which the colours are divided first, as PNG wants it.
Expected<std::vector<std::uint8_t>> encode_png(const Image& image);

/// PNG of pixels that are ready for the display: sRGB, 8 bits of red, green and blue, row by row from the
/// top. An error if there are not width × height of them.
Expected<std::vector<std::uint8_t>> encode_png_bytes(int width, int height,
                                                     std::span<const std::uint8_t> pixels);

}  // namespace penumbra
