// Reading and encoding through OpenImageIO, which stays out of the program until it is used: the 250
// libraries behind Debian's OpenImageIO cost every start 0.2 s and 120 MB. So this is a module of its own,
// loaded at the first use.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/outputs/image.h"

namespace penumbra {

/// What the module offers; the functions are those of image.h and image_files.h.
struct ImageIo {
  Expected<Image> (*read)(const std::filesystem::path& path);
  Expected<std::vector<std::uint8_t>> (*encode_exr)(const Image& image);
  Expected<std::vector<std::uint8_t>> (*encode_png)(const Image& image);
};

/// The module, loaded by the first call. Thread-safe. Error: it is neither beside the executable nor where
/// the system looks for libraries.
Expected<const ImageIo*> image_io();

}  // namespace penumbra
