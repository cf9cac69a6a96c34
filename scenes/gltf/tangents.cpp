#include "scenes/gltf/tangents.h"

#include <cstdint>
#include <limits>

namespace penumbra::gltf {
namespace {

/// The texture coordinates of a triangle, relative to its first vertex.
struct UvEdges {
  glm::dvec2 first, second;
  UvEdges(const Mesh& mesh, const glm::uvec3& t)
      : first(mesh.texcoords[t.y] - mesh.texcoords[t.x]), second(mesh.texcoords[t.z] - mesh.texcoords[t.x]) {}
  [[nodiscard]] double area() const { return first.x * second.y - first.y * second.x; }
};

}  // namespace

std::vector<bool> mirrored_triangles(const Mesh& mesh, const std::optional<AccessorValues>& tangents) {
  std::vector<bool> mirrored;
  mirrored.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    double sign = 0.0;
    if (tangents) sign = tangents->at(t.x, 3) + tangents->at(t.y, 3) + tangents->at(t.z, 3);
    if (sign == 0.0 && !mesh.texcoords.empty()) sign = -UvEdges(mesh, t).area();
    mirrored.push_back(sign < 0.0);
  }
  return mirrored;
}

bool has_other_tangents(const Mesh& mesh, const AccessorValues& tangents) {
  constexpr double kLeastCosine = 0.70710678;
  if (mesh.texcoords.empty()) return false;
  for (const glm::uvec3& t : mesh.triangles) {
    const UvEdges uv(mesh, t);
    const glm::dvec3 e1 = mesh.positions[t.y] - mesh.positions[t.x],
                     e2 = mesh.positions[t.z] - mesh.positions[t.x];
    const glm::dvec3 along = (e1 * uv.second.y - e2 * uv.first.y) * (uv.area() < 0.0 ? -1.0 : 1.0);
    for (int corner = 0; corner < 3; ++corner) {
      const std::size_t v = t[corner];
      const glm::dvec3 given(tangents.at(v, 0), tangents.at(v, 1), tangents.at(v, 2));
      if (glm::dot(given, along) < kLeastCosine * glm::length(given) * glm::length(along)) return true;
    }
  }
  return false;
}

Mesh part_of(const Mesh& mesh, const std::vector<bool>& wanted) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> places(mesh.positions.size(), kNone);
  Mesh part;
  const auto copy = [](const auto& from, std::size_t i, auto& to) {
    if (!from.empty()) to.push_back(from[i]);
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!wanted[i]) continue;
    glm::uvec3 t = mesh.triangles[i];
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t v = t[corner];
      if (places[v] == kNone) {
        places[v] = std::uint32_t(part.positions.size());
        part.positions.push_back(mesh.positions[v]);
        copy(mesh.normals, v, part.normals);
        copy(mesh.texcoords, v, part.texcoords);
        copy(mesh.colours, v, part.colours);
      }
      t[corner] = places[v];
    }
    part.triangles.push_back(t);
    copy(mesh.face_colours, i, part.face_colours);
  }
  return part;
}

}  // namespace penumbra::gltf
