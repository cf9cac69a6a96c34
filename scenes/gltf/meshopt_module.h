// Buffer views that meshoptimizer compressed (EXT_meshopt_compression), behind a module that is loaded once a
// file has one, and that is there where meshoptimizer was when it was built.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra::gltf {

/// Of how many elements of how many bytes, and how they are packed: the names that the extension has for it.
struct MeshoptPacking {
  std::size_t count = 0, stride = 0;
  std::string mode, filter = "NONE";
};

/// What the module offers, under the name penumbra_meshopt_reader.
struct MeshoptReader {
  /// The elements, side by side. Errors: damaged, a mode, filter or stride that the extension does not have.
  Expected<std::string> (*read)(std::string_view bytes, const MeshoptPacking& packing);
};

}  // namespace penumbra::gltf
