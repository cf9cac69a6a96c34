// Encodes image files. The bytes depend only on the image, not on time, host or process ID, so equal images
// give equal files.
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
  bool half = false;  ///< 16 bits for channels for which that suffices; see is_half_channel
};

/// Whether 16 bits suffice for the channel: colours, alpha and normals, but not variances, distances and
/// counts, which need more than 11 bits of precision or values above 65504.
bool is_half_channel(std::string_view name);

/// The number of values in those channels that exceed the range of 16-bit floats. They are clamped in the
/// file.
std::uint64_t values_beyond_half(const Image& image);

/// Encodes OpenEXR: all channels, by default as 32-bit floats with ZIP compression; data and display window,
/// all metadata, camera and chromaticities as standard attributes. With a compression that is lossy for
/// floats, exact channels are stored in a separate part, together with the metadata cryptomatte/….
Expected<std::vector<std::uint8_t>> encode_exr(const Image& image, const ExrEncoding& encoding = {});

/// Encodes PNG: the beauty layer of the data window as picture_of shows it, with 8 bits per channel, and
/// alpha if the image has it.
Expected<std::vector<std::uint8_t>> encode_png(const Image& image);

/// Encodes PNG from display-ready sRGB pixels: 8 bits of red, green and blue (and alpha), row by row from the
/// top. Error: their number is not width × height.
Expected<std::vector<std::uint8_t>> encode_png_bytes(int width, int height,
                                                     std::span<const std::uint8_t> pixels,
                                                     bool has_alpha = false);

}  // namespace penumbra
