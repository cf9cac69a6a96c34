// Texture coordinates of triangles, and the triangles whose coordinates lights have.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Of the triangle of these vertices of the mesh. Without texture coordinates they are Mitsuba's: barycentric
/// ones of the second and third vertex; `flipped`: which the caller exchanged.
VertexUvs vertex_uvs(const Mesh& mesh, const glm::uvec3& corner, bool flipped);

/// The colours of a triangle of the mesh with these vertices; black where it has none.
VertexColours triangle_colours(const Mesh& mesh, MeshAttribute attribute, const glm::uvec3& corner,
                               std::size_t triangle);

/// For each light the triangles that are it, none twice where triangles repeat others, or the quadric.
std::vector<LightTriangles> light_triangles(std::span<const Triangle> triangles,
                                            std::span<const Quadric> quadrics, std::size_t lights);

}  // namespace penumbra
