// The shape in which a mesh rests: its morph targets by their default weights, its skin by its joints.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scenes/gltf/primitive_attributes.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// Adds the primitive's morph targets, times their weights, to a mesh in its own space; weights that are not
/// there are 0. Errors: see read_accessor; targets of another number of vertices.
Expected<void> morph(const Asset& asset, const tinygltf::Primitive& primitive,
                     std::span<const double> weights, Mesh& mesh);

/// Takes a mesh from its own space to the world's by the joints of a skin, where those are: glTF ignores the
/// transform of the node that has the mesh. Errors: no such skin or joint, no joints and weights of vertices,
/// others of read_accessor.
Expected<void> apply_skin(const Asset& asset, const PrimitiveAttributes& attributes, int skin,
                          const std::vector<glm::dmat4>& node_to_world, Mesh& mesh);

}  // namespace penumbra::gltf
