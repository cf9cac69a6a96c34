// Tangents of a primitive, and on which of its triangles they mirror a normal map.
#pragma once

#include <vector>

#include "scenes/gltf/accessor.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// Gives the triangles' corners the tangents of their vertices.
void set_tangents(const AccessorValues& of_vertices, Mesh& mesh);

/// For each triangle, whether its bitangent is the negative cross product of normal and tangent: where the
/// fourth component of TANGENT is -1, and without tangents of the file where the texture coordinates have
/// that winding (glTF 2.0, 3.7.2.1). In glTF the second coordinate points down and green up.
std::vector<bool> mirrored_triangles(const Mesh& mesh, bool has_own_tangents);

}  // namespace penumbra::gltf
