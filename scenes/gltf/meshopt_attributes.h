// What KHR_meshopt_compression has beyond EXT_meshopt_compression, which Debian's meshoptimizer (0.18) does
// not know.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra::gltf {

/// Whether the bytes are a stream of attributes of version 1.
bool is_attributes_1(std::string_view bytes);

/// The elements of such a stream, side by side; a stride of 4 to 256 bytes, a multiple of 4 (the extension's
/// Appendix A, Mode 0). Errors: damaged.
Expected<std::string> read_attributes_1(std::string_view bytes, std::size_t count, std::size_t stride);

/// The filter for colours of four components of 8 or 16 bits, in place: YCoCg to RGB (Appendix B, Filter 4).
void unfilter_colours(std::span<char> elements, std::size_t stride);

}  // namespace penumbra::gltf
