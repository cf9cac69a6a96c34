// Reads Radiance's picture files (.hdr), which most environment maps are.
#pragma once

#include <cstddef>
#include <string_view>

#include "scenes/image/image_module.h"

namespace penumbra {

/// Reads a Radiance picture in the usual orientation into `image`. Returns false for a file of another
/// orientation or format, a truncated or damaged one, or one larger than `most_bytes`.
bool read_radiance(std::string_view contents, std::size_t most_bytes, ImageContents& image);

}  // namespace penumbra
