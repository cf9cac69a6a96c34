// The interface to buffer views compressed by meshoptimizer (EXT_meshopt_compression). The code lives in a
// separate module. It is loaded when a file has such a view, and it exists only if meshoptimizer was present
// when the renderer was built.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "kernels/host/error.h"

namespace penumbra::gltf {

/// The number and size of the elements and their compression, with the extension's names.
struct MeshoptPacking {
  std::size_t count = 0, stride = 0;
  std::string mode, filter = "NONE";
};

/// The interface that the module exports under the name penumbra_meshopt_reader.
struct MeshoptReader {
  /// Decodes packed elements. Errors: damaged data; a mode, filter or stride that the extension does not
  /// define.
  Expected<std::string> (*read)(std::string_view bytes, const MeshoptPacking& packing);
};

}  // namespace penumbra::gltf
