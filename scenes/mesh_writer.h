// Meshes as files.
#pragma once

#include <string>

#include "scenes/scene_description.h"

namespace penumbra {

/// A binary, little-endian PLY file of all that a mesh has: read_ply makes the same mesh of it.
std::string ply_of(const Mesh& mesh);

}  // namespace penumbra
