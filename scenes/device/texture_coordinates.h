// Texture coordinates and tangents of triangles, and the triangles that belong to each light.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kernels/scene_types.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The texture coordinates of a triangle of the mesh. A mesh without texture coordinates gets Mitsuba's
/// default: the barycentric coordinates of the second and third vertex. `flipped`: the caller exchanged these
/// two.
VertexUvs vertex_uvs(const Mesh& mesh, const glm::uvec3& corner, bool flipped);

/// The tangents of a triangle of the mesh whose vertices are now those of `record`; 0 if it has none.
/// `mirrors_maps`: see Shape. `flipped`: as above.
VertexTangents vertex_tangents(const Mesh& mesh, std::size_t triangle, const Triangle& record,
                               bool mirrors_maps, bool flipped);

/// The vertex colours of a triangle of the mesh; black if the mesh has none.
VertexColours triangle_colours(const Mesh& mesh, MeshAttribute attribute, const glm::uvec3& corner,
                               std::size_t triangle);

/// For each light its triangles, without duplicates, or its quadric.
std::vector<LightTriangles> light_triangles(std::span<const Triangle> triangles,
                                            std::span<const Quadric> quadrics, std::size_t lights);

}  // namespace penumbra
