// The transforms of the nodes of a glTF file.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scenes/gltf/asset.h"
#include "scenes/reader_report.h"

namespace penumbra::gltf {

/// The transform composed of scale, then rotation, then translation, as in a node. The rotation is a
/// quaternion (x, y, z, w) of any length.
glm::dmat4 transform_of_parts(const glm::dvec3& translation, const glm::dvec4& rotation,
                              const glm::dvec3& scale);

/// The transform of a node relative to its parent. Nothing, and an error, if its numbers are not valid.
std::optional<glm::dmat4> local_transform(const Asset& asset, std::size_t node, ReaderReport& report);

/// The world transforms of all nodes, including those outside the scene, because joints of skins may be
/// there. A node that is reached more than once, or that has no valid transform, is placed as if it had no
/// parent.
std::vector<glm::dmat4> world_transforms(const Asset& asset);

/// The instances of a node's mesh (EXT_mesh_gpu_instancing), relative to the node. Nothing if it has none.
/// Errors: those of read_accessor; attributes of different counts.
Expected<std::optional<std::vector<glm::dmat4>>> node_instances(const Asset& asset,
                                                                const tinygltf::Node& node);

}  // namespace penumbra::gltf
