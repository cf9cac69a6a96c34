// The interface to meshes compressed by Draco (KHR_draco_mesh_compression). The code lives in a separate
// module. It is loaded when a file has such a mesh, and it exists only if libdraco was present when the
// renderer was built.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra::gltf {

struct DracoAttribute {
  std::size_t components = 1;   ///< components per vertex
  std::vector<double> numbers;  ///< as stored: integers are not normalised
};

struct DracoMesh {
  std::size_t vertices = 0;
  std::vector<std::uint32_t> corners;          ///< three per triangle
  std::map<int, DracoAttribute> attributes{};  ///< keyed by Draco's unique attribute ID
};

/// The interface that the module exports under the name penumbra_draco_reader.
struct DracoReader {
  /// Decodes a mesh and the given attributes. Errors: damaged data, not a triangle mesh, no such attribute.
  Expected<DracoMesh> (*read)(std::string_view bytes, std::span<const int> attributes);
};

}  // namespace penumbra::gltf
