// Reading image files through OpenImageIO, behind a module that is loaded once a scene has a bitmap: the 250
// libraries behind Debian's OpenImageIO would cost every start 0.2 s and 120 MB.
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

/// The first image of a file, with all its channels.
struct ImageContents {
  int width = 0, height = 0;
  std::vector<std::string> channels;  ///< names, in the order in which a texel has them
  TexelType type = TexelType::kByte;
  std::vector<std::byte> bytes;
  /// Of R, G and B, where the file says others than Rec. 709's; its texels are floats then.
  std::optional<Chromaticities> chromaticities = {};
};

/// What the module offers, under the name penumbra_texel_reader.
struct TexelReader {
  /// `name` says the format, unless the contents do. Errors: of no format that is known, no pixels, larger
  /// than `most_bytes` (which is known before they are read), truncated or broken.
  Expected<ImageContents> (*read)(const std::string& name, std::string_view contents, std::size_t most_bytes);
};

}  // namespace penumbra
