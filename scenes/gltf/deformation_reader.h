// Meshes of glTF in their pose: morph targets and skins, as values that scenes/motion/mesh_deformation.h
// evaluates.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "scenes/gltf/animation_reader.h"
#include "scenes/gltf/moving_nodes.h"
#include "scenes/gltf/primitive_attributes.h"
#include "scenes/motion/mesh_deformation.h"
#include "scenes/scene_description.h"

namespace penumbra::gltf {

/// A primitive's mesh in the pose that the file's nodes have: in its own space, or with a skin in world
/// space. If it deforms, it is at rest instead, in its own space.
struct PosedMesh {
  Mesh mesh;
  std::shared_ptr<const MeshDeformation> deformation{};  ///< null: it does not deform
};

struct PoseReading {
  const Asset& asset;
  const Animation& animation;
  const std::vector<glm::dmat4>& node_to_world;
  MovingNodes& moving;  ///< joints are added
};

/// Reads a primitive of the mesh of a node. `wants_tangents`: with those of the file, or else, and without
/// normals, those of MikkTSpace, as glTF 2.0 has it (3.7.2.1). Errors: those of read_primitive; targets with
/// another number of vertices; no such skin or joint; vertices without joints or weights.
Expected<PosedMesh> read_posed(std::size_t node, const tinygltf::Primitive& primitive, int texcoord,
                               bool wants_tangents, const PoseReading& reading);

}  // namespace penumbra::gltf
