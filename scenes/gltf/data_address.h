// What addresses of glTF's buffers and images say: data themselves, or a file's name.
#pragma once

#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra::gltf {

/// Whether the address holds data, and not a name (RFC 2397).
bool is_data_address(std::string_view address);

/// The data that an address holds, of whatever media type. Errors: no comma, not base64.
Expected<std::string> data_of_address(std::string_view address);

/// With %20 and the like as what they stand for; what is no such escape stays (RFC 3986, 2.1).
std::string percent_decoded(std::string_view text);

}  // namespace penumbra::gltf
