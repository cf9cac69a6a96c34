// Meshes by their faces. In pbrt each triangle, or each patch of a bilinear mesh, is a shape of its own.
#pragma once

#include <vector>

#include "scenes/scene_description.h"

namespace penumbra::pbrt {

/// Gives each face the texture coordinates of pbrt's faces without any: (0, 0), (1, 0), (1, 1) at the corners
/// of a triangle; of a patch its own u and v. Faces share no vertices afterwards. `patches`: every two
/// triangles are a patch, of corners 0 1 3 and 0 3 2.
void set_default_coordinates(Mesh& mesh, bool patches);

/// A part of a mesh, and the area of one of its faces.
struct FacesOfArea {
  Mesh mesh;
  double face_area;
};

/// The mesh in parts whose faces have the same area, up to a share of kAreaSpread; faces without area are
/// left out. `face_triangles`: triangles of a face, which follow each other.
constexpr double kAreaSpread = 1e-3;
std::vector<FacesOfArea> split_by_face_area(const Mesh& mesh, std::size_t face_triangles);

}  // namespace penumbra::pbrt
