// Writes meshes to files.
#pragma once

#include <string>

#include "scenes/scene_description.h"

namespace penumbra {

/// The mesh as a binary, little-endian PLY file. read_ply restores the same mesh.
std::string ply_of(const Mesh& mesh);

}  // namespace penumbra
