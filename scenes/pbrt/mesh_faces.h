// Meshes by their faces. In pbrt each triangle, or each patch of a bilinear mesh, is a shape of its own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/scene_description.h"

namespace penumbra::pbrt {

/// Where a triangle was in its file's mesh, before those without area were left out.
struct TriangleOrigin {
  std::uint32_t index = 0;  ///< among all triangles of the mesh
  bool turned = false;      ///< whether its second and its third corner have changed places
  bool operator==(const TriangleOrigin&) const = default;
};

/// The origins of the triangles `after` place_mesh, from those `before`. They have the same order.
std::vector<TriangleOrigin> origins_of(std::span<const glm::uvec3> before, std::span<const glm::uvec3> after);

/// Gives each face the texture coordinates of pbrt's faces without any: (0, 0), (1, 0), (1, 1) at the corners
/// of a triangle; of a patch its own u and v. Faces share no vertices afterwards. `origins`: one for
/// each triangle. `patches`: every two triangles of the file are a patch, of corners 0 1 3 and 0 3 2.
void set_default_coordinates(Mesh& mesh, std::span<const TriangleOrigin> origins, bool patches);

/// A part of a mesh, and the area of one of its faces.
struct FacesOfArea {
  Mesh mesh;
  std::vector<TriangleOrigin> origins;  ///< of the part's triangles
  double face_area;
};

/// The mesh in parts whose faces have the same area, up to a share of kAreaSpread. `origins`: one for each
/// triangle. `face_triangles`: how many consecutive triangles of the file are a face, of which those without
/// area are left out.
constexpr double kAreaSpread = 1e-3;
std::vector<FacesOfArea> split_by_face_area(const Mesh& mesh, std::span<const TriangleOrigin> origins,
                                            std::size_t face_triangles);

}  // namespace penumbra::pbrt
