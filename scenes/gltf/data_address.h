// The URIs of glTF's buffers and images: either embedded data or a file name.
#pragma once

#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra::gltf {

/// Whether the URI contains data (RFC 2397).
bool is_data_address(std::string_view address);

/// The data embedded in a URI, of any media type. Errors: no comma, not base64.
Expected<std::string> data_of_address(std::string_view address);

/// Decodes percent escapes such as %20 (RFC 3986, 2.1). Malformed escapes are kept.
std::string percent_decoded(std::string_view text);

}  // namespace penumbra::gltf
