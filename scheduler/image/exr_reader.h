// Reads the OpenEXR files that renderers write, without OpenImageIO.
#pragma once

#include <filesystem>
#include <optional>

#include "scheduler/image/image.h"

namespace penumbra {

/// What read_image, or with `with_values` false read_image_header, gives for a file of one part whose
/// channels are halfs or floats, one value a pixel, and whose attributes OpenImageIO does not rename. Nothing
/// for any other file, and for one that is damaged.
std::optional<Image> read_plain_exr(const std::filesystem::path& path, bool with_values);

}  // namespace penumbra
