// Reading through OpenImageIO, which stays out of the program until an image is read: the 250 libraries
// behind Debian's OpenImageIO would cost every start 0.2 s and 120 MB. So it is behind a module that is
// loaded at the first use.
#pragma once

#include <filesystem>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// What the module offers, under the name penumbra_image_reader.
struct ImageReader {
  Expected<Image> (*read)(const std::filesystem::path& path);  ///< see read_image
};

}  // namespace penumbra
