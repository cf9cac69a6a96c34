// The rest pose of a mesh: morph targets with their default weights, and skinning.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scenes/gltf/primitive_attributes.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// Adds the primitive's morph targets, times their weights, to a mesh in its own space. Missing weights are
/// 0. Errors: those of read_accessor; targets with another number of vertices.
Expected<void> morph(const Asset& asset, const tinygltf::Primitive& primitive,
                     std::span<const double> weights, Mesh& mesh);

/// Transforms a skinned mesh to world space by the joints of its skin. glTF ignores the transform of the node
/// that holds the mesh. Errors: no such skin or joint, vertices without joints and weights, those of
/// read_accessor.
Expected<void> apply_skin(const Asset& asset, const PrimitiveAttributes& attributes, int skin,
                          const std::vector<glm::dmat4>& node_to_world, Mesh& mesh);

}  // namespace penumbra::gltf
