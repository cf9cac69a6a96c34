// Meshes that Draco compressed (KHR_draco_mesh_compression), behind a module that is loaded once a file has
// one, and that is there where libdraco was when it was built.
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
  std::size_t components = 1;   ///< of each vertex
  std::vector<double> numbers;  ///< as they are stored: whole numbers are not normalised
};

struct DracoMesh {
  std::size_t vertices = 0;
  std::vector<std::uint32_t> corners;          ///< three for each triangle
  std::map<int, DracoAttribute> attributes{};  ///< by the unique id that Draco gives them
};

/// What the module offers, under the name penumbra_draco_reader.
struct DracoReader {
  /// A mesh with those of its attributes. Errors: damaged, not of triangles, no such attribute.
  Expected<DracoMesh> (*read)(std::string_view bytes, std::span<const int> attributes);
};

}  // namespace penumbra::gltf
