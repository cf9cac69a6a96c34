#include "scenes/gltf/tangents.h"

#include <cstddef>

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

}  // namespace penumbra::gltf
