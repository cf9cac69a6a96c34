// The transforms of the nodes of a glTF file.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scenes/gltf/asset.h"
#include "scenes/reader_report.h"

namespace penumbra::gltf {

/// A node's translation or scale; all components are `fallback` if it has none.
glm::dvec3 vector_or(const std::vector<double>& numbers, double fallback);

/// The transform composed of scale, then rotation, then translation, as in a node. The rotation is a
/// quaternion (x, y, z, w) of any length.
glm::dmat4 transform_of_parts(const glm::dvec3& translation, const glm::dvec4& rotation,
                              const glm::dvec3& scale);

/// The root nodes of the scene to show; in a file without scenes all nodes without a parent.
std::vector<int> root_nodes(const Asset& asset, ReaderReport& report);

/// Whether the transform leaves an area to any triangle, that is, flattens at most one axis.
bool keeps_areas(const glm::dmat4& transform);

/// The transform of a node relative to its parent. Nothing, and an error, if its numbers are not valid.
std::optional<glm::dmat4> local_transform(const Asset& asset, std::size_t node, ReaderReport& report);

/// The same without a message.
std::optional<glm::dmat4> local_transform(const tinygltf::Node& node);

/// The parent of each node, or -1. A cycle is cut open.
std::vector<int> node_parents(const Asset& asset);

/// The world transforms of all nodes, including those outside the scene, because joints of skins may be
/// there. A node without a valid transform is where its parent is.
std::vector<glm::dmat4> world_transforms(const Asset& asset);

/// The instances of a node's mesh (EXT_mesh_gpu_instancing), relative to the node. Nothing if it has none.
/// Errors: those of read_accessor; attributes of different counts.
Expected<std::optional<std::vector<glm::dmat4>>> node_instances(const Asset& asset,
                                                                const tinygltf::Node& node);

}  // namespace penumbra::gltf
