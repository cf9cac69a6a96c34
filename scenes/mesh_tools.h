// What every mesh goes through between its file and the scene.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra {

struct MeshCleaning {
  std::size_t flat_triangles = 0;  ///< left out: they have no area
  std::size_t bad_normals = 0;     ///< missing, of no length or an infinite one: replaced by computed ones
};

/// What readers warn of: "left out 2 triangles without area", "1 normal is missing or of no length; …".
std::vector<std::string> describe(const MeshCleaning& cleaning);

/// Takes a mesh from its own space to the world's and makes it fit to render:
///  - without normals of its own, and unless `face_normals`, it gets smooth ones, weighted by the angle of
///  each corner
///    (Thürmer and Wüthrich 1998), as Mitsuba does; a mesh that is flat at every vertex stays faceted;
///  - a triangle whose corners' normals point to its back is wound the other way, so that the geometric and
///  the
///    shading normal agree; one without normals keeps its winding, and so its front side turns with a mirror;
///  - triangles without area, or with one too small for single precision, are left out.
/// `to_world` is not singular. Errors: as of check_traceable; all triangles are too small.
Expected<MeshCleaning> place_mesh(Mesh& mesh, const glm::dmat4& to_world, bool face_normals);

/// Gives a faceted mesh normals that are smooth but for edges: about every point, faces that are at most
/// `degrees` from the first of them share a normal, weighted by the angles of their corners; then the first
/// of those that are left, and so on (Mitsuba 0.6's rule). Vertices are split where that takes it. One
/// without a smooth vertex stays faceted. Its triangles have area.
void smooth_up_to(Mesh& mesh, double degrees);

/// Takes a mesh's normals away if all of them are those of its faces, but for the rounding of files: normals
/// of four decimals, on triangles of six decimals and a thousandth of the scene's unit. Then it is faceted,
/// and exactly so. Its triangles have area.
void drop_face_normals(Mesh& mesh);

/// The square [-1, 1]² at z = 0 with its front towards +z, faceted, under a transform; the front follows the
/// transformed normal.
Mesh make_rectangle(const glm::dmat4& to_world);

/// The unit disk at z = 0 with its front towards +z, under a transform, as a polygon of the same area; the
/// front follows the transformed normal. Texture coordinates are Mitsuba's: the distance from the centre, and
/// the share of a turn.
Mesh make_elliptic_disk(const glm::dmat4& to_world);

/// The cube [-1, 1]³ with its front outside, faceted, under a transform.
Mesh make_cube(const glm::dmat4& to_world);

}  // namespace penumbra
