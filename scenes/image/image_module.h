// The interface to OpenImageIO, which reads image files. The code lives in a separate module that is loaded
// when a scene has a bitmap that common_formats.h does not read. Otherwise the 250 libraries behind Debian's
// OpenImageIO would add half a second and 120 MB to every start.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/host/chromaticities.h"
#include "kernels/host/error.h"
#include "scenes/image/bitmap.h"

namespace penumbra {

/// The first image of a file with all its channels.
struct ImageContents {
  int width = 0, height = 0;
  std::vector<std::string> channels;  ///< names of the channels, in the order within a texel
  TexelType type = TexelType::kByte;
  std::vector<std::byte> bytes;
  /// The primaries and white point, if the file states others than Rec. 709's. The texels are floats then.
  std::optional<Chromaticities> chromaticities = {};
};

/// The interface that the module exports under the name penumbra_texel_reader.
struct TexelReader {
  /// Reads an image. `name` determines the format if the contents do not. Errors: an unknown format, no
  /// pixels, larger than `most_bytes` (checked before reading texels), truncated or damaged.
  Expected<ImageContents> (*read)(const std::string& name, std::string_view contents, std::size_t most_bytes);
};

}  // namespace penumbra
