// Tangents of meshes by MikkTSpace, which normal maps of most programs are made for.
#pragma once

#include <array>
#include <glm/vec4.hpp>
#include <vector>

namespace penumbra {

struct Mesh;

/// For the corners of each triangle the unit tangent, perpendicular to the normal there, and in w the sign of
/// the bitangent sign * cross(normal, tangent). By the definition in M. S. Mikkelsen, "Simulation of Wrinkled
/// Surfaces Revisited" (2008), and its reference implementation for triangles: corners with equal position,
/// normal and texture coordinates are one vertex. The triangles around it that are joined by edges, and whose
/// texture coordinates have one orientation, share the mean of their directions of u, each projected and
/// weighted by its angle there. Triangles whose texture coordinates span no area only take part in what their
/// neighbours share. Where nothing gives a tangent it is 0. The mesh needs texture coordinates; without
/// normals those of its faces are meant.
std::vector<std::array<glm::vec4, 3>> mikktspace_tangents(const Mesh& mesh);

}  // namespace penumbra
