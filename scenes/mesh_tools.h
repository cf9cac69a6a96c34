// Steps that prepare a mesh from a file for rendering, and meshes of simple shapes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra {

struct MeshCleaning {
  std::size_t flat_triangles = 0;  ///< triangles left out because they have no area
  /// Normals that were missing, zero or infinite, and were replaced by computed ones.
  std::size_t bad_normals = 0;
};

/// The warnings of readers: "left out 2 triangles without area", "1 normal is missing or of no length; …".
std::vector<std::string> describe(const MeshCleaning& cleaning);

/// Transforms a mesh to world space and prepares it for rendering:
///   - Smooth normals are computed if the mesh has none and `face_normals` is false. They are weighted by the
///     angle of each corner (Thürmer and Wüthrich 1998), as in Mitsuba. A mesh that is flat at every vertex
///     stays faceted.
///   - A triangle whose vertex normals point to its back gets the opposite winding, so that the geometric and
///     the shading normal agree. A triangle without normals keeps its winding, so a mirroring transform swaps
///     its front and back.
///   - Triangles without area, or with an area too small for single precision, are left out.
///   - Tangents are transformed, or computed if the mesh says so: in its own space, or in world space if its
///     normals are computed, too.
/// `to_world` must not be singular. Errors: those of check_traceable; no triangle is left.
Expected<MeshCleaning> place_mesh(Mesh& mesh, const glm::dmat4& to_world, bool face_normals);

/// Gives a faceted mesh normals that are smooth except at edges (Mitsuba 0.6's rule). At every point, the
/// faces within `degrees` of the first of them share a normal, weighted by the angles of their corners; then
/// the first of the remaining faces starts the next group, and so on. Vertices are split where necessary. A
/// mesh without a smooth vertex stays faceted. All triangles must have area.
void smooth_up_to(Mesh& mesh, double degrees);

/// Reverses the winding of a triangle.
void turn_over(Mesh& mesh, std::size_t triangle);

/// Transforms the tangents of a mesh; they keep no length.
void transform_tangents(Mesh& mesh, const glm::dmat4& to_world);

/// Appends a vertex of `from`, with all that belongs to it. Returns its index.
std::uint32_t copy_vertex(const Mesh& from, std::uint32_t vertex, Mesh& to);

/// These triangles of the mesh, and the vertices that they have.
Mesh part_of(const Mesh& mesh, std::span<const std::size_t> triangles);

/// The cross product of the triangle's edges: along its normal, of twice its area.
glm::dvec3 face_vector(const Mesh& mesh, const glm::uvec3& triangle);

/// Removes vertex normals that all equal the face normals up to the rounding of files: normals with four
/// decimals, on triangles with six decimals and a size of a thousandth of the scene's unit. The mesh is then
/// exactly faceted. All triangles must have area.
void drop_face_normals(Mesh& mesh);

/// The square [-1, 1]² at z = 0 with its front towards +z, faceted and transformed. The front follows the
/// transformed normal.
Mesh make_rectangle(const glm::dmat4& to_world);

/// The unit disk at z = 0 with its front towards +z, transformed, as a polygon of the same area. The front
/// follows the transformed normal. Texture coordinates are Mitsuba's: the distance from the centre, and the
/// fraction of a full turn.
Mesh make_elliptic_disk(const glm::dmat4& to_world);

/// The cube [-1, 1]³ with its front outside, faceted and transformed.
Mesh make_cube(const glm::dmat4& to_world);

}  // namespace penumbra
