// Reads OpenEXR files with OpenEXR.
#pragma once

#include <cstddef>
#include <string_view>

#include "kernels/host/error.h"
#include "scenes/image/image_module.h"

namespace penumbra {

bool is_exr(std::string_view contents);

/// The colours of the first part that has some, with their alpha; a single channel of a file of one part is
/// taken whatever its name. The texels are those of the data window, at the finest level. Halfs and floats
/// stay; integers become the floats of the same value, and so do channels of several types. Luminance with
/// chroma becomes R, G and B. Errors: damaged or incomplete, a deep image, no colours, X, Y and Z together,
/// more than `most_bytes`.
Expected<ImageContents> read_exr(std::string_view contents, std::size_t most_bytes);

}  // namespace penumbra
