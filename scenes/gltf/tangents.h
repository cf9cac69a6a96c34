// On which triangles of a mesh the texture coordinates mirror its normal map.
#pragma once

#include <optional>
#include <vector>

#include "scenes/gltf/accessor.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// For each triangle, whether its bitangent is the negative cross product of normal and tangent: where the
/// fourth component of TANGENT is -1, and without tangents where the texture coordinates have that winding
/// (as MikkTSpace defines it; glTF 2.0, 3.7.2.1). In glTF the second coordinate points down and green up.
std::vector<bool> mirrored_triangles(const Mesh& mesh, const std::optional<AccessorValues>& tangents);

/// Whether a given tangent leans by more than 45 degrees from the direction in which the first texture
/// coordinate grows on one of its triangles.
bool has_other_tangents(const Mesh& mesh, const AccessorValues& tangents);

}  // namespace penumbra::gltf
