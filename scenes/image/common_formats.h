// Reads the images that most textures are, with the libraries of their formats.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "scenes/image/image_module.h"

namespace penumbra {

/// An image of a usual JPEG or PNG file, with the same contents as from TexelReader.
/// Loading OpenImageIO with its 250 libraries takes half a second, which is more than reading most scenes.
/// Nothing: another format or variant, a damaged file, or an image larger than `most_bytes`. TexelReader
/// reads those, or says what is wrong with them.
std::optional<ImageContents> read_common_image(std::string_view contents, std::size_t most_bytes);

}  // namespace penumbra
