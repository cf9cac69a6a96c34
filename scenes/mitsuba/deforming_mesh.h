// Meshes of several files, each at a time.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "scenes/mitsuba/object_tree.h"
#include "scenes/motion/mesh_deformation.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

/// A mesh in its own space, as the first of its files has it, and how it becomes the others.
struct DeformingMesh {
  Mesh rest;
  std::shared_ptr<const MeshDeformation> deformation;
  glm::dmat4 to_world{1.0};  ///< unless that moves

  /// Whether the files differ.
  [[nodiscard]] bool changes() const;
};

/// One that moves evenly from each of the `meshes`, those of the files, to the next. Faces, texture
/// coordinates and colours are the first one's. Null, and an error at its file, if one has other numbers of
/// vertices or triangles than the first, or normals where that has none, or the reverse.
std::shared_ptr<const DeformingMesh> deforming_mesh(std::vector<Mesh> meshes, std::span<const TextKey> files,
                                                    const glm::dmat4& to_world, Diagnostics& diagnostics);

}  // namespace penumbra::mitsuba
