// Where the nodes of a glTF file are.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scenes/gltf/asset.h"
#include "scenes/reader_report.h"

namespace penumbra::gltf {

/// A translation, a rotation (x, y, z, w) of any length, and a scale, in the order in which nodes apply them.
glm::dmat4 transform_of_parts(const glm::dvec3& translation, const glm::dvec4& rotation,
                              const glm::dvec3& scale);

/// Of a node within its parent; nothing, and an error, where it has no such numbers.
std::optional<glm::dmat4> local_transform(const Asset& asset, std::size_t node, ReaderReport& report);

/// Of all nodes in the world, those outside the scene too: joints of skins may be. A node that its parents
/// lead to more than once, or that has no transform, is where it would be without parents.
std::vector<glm::dmat4> world_transforms(const Asset& asset);

/// The instances of a node's mesh (EXT_mesh_gpu_instancing), within the node; nothing where it has none.
/// Errors: see read_accessor; attributes of different counts.
Expected<std::optional<std::vector<glm::dmat4>>> node_instances(const Asset& asset,
                                                                const tinygltf::Node& node);

}  // namespace penumbra::gltf
