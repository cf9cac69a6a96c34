// The interface to OpenImageIO. The code lives in a separate module that is loaded when an image is read.
// Otherwise the 250 libraries behind Debian's OpenImageIO would add 0.2 s and 120 MB to every start. Most
// OpenEXR files do not need it; see exr_reader.h.
#pragma once

#include <filesystem>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// The interface that the module exports under the name penumbra_image_reader.
struct ImageReader {
  Expected<Image> (*read)(const std::filesystem::path& path);         ///< see read_image
  Expected<Image> (*read_header)(const std::filesystem::path& path);  ///< see read_image_header
};

}  // namespace penumbra
