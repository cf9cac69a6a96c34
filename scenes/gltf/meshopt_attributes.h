// The parts of KHR_meshopt_compression that EXT_meshopt_compression lacks. Debian's meshoptimizer (0.18) does
// not support them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra::gltf {

/// Whether the bytes are an attribute stream of version 1.
bool is_attributes_1(std::string_view bytes);

/// Decodes an attribute stream to packed elements (the extension's Appendix A, Mode 0). The stride is 4 to
/// 256 bytes and a multiple of 4. Errors: damaged data.
Expected<std::string> read_attributes_1(std::string_view bytes, std::size_t count, std::size_t stride);

/// Applies the colour filter in place, for four components of 8 or 16 bits: YCoCg to RGB (Appendix B, Filter
/// 4).
void unfilter_colours(std::span<char> elements, std::size_t stride);

}  // namespace penumbra::gltf
