#include "scenes/gltf/tangents.h"

#include <array>
#include <cstddef>

namespace penumbra::gltf {

void set_tangents(const AccessorValues& of_vertices, Mesh& mesh) {
  mesh.tangents.clear();
  for (const glm::uvec3& t : mesh.triangles) {
    std::array<glm::vec4, 3>& corners = mesh.tangents.emplace_back();
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 4; ++k) corners[std::size_t(c)][k] = float(of_vertices.at(t[c], std::size_t(k)));
  }
}

std::vector<bool> mirrored_triangles(const Mesh& mesh, bool has_own_tangents) {
  std::vector<bool> mirrored;
  mirrored.reserve(mesh.triangles.size());
  const auto sign_of = [&](std::size_t i) {
    return mesh.tangents.empty() ? 0.0f
                                 : mesh.tangents[i][0].w + mesh.tangents[i][1].w + mesh.tangents[i][2].w;
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    double sign = has_own_tangents ? sign_of(i) : 0.0;
    if (sign == 0.0 && !mesh.texcoords.empty()) {
      const glm::uvec3& t = mesh.triangles[i];
      const glm::dvec2 first = mesh.texcoords[t.y] - mesh.texcoords[t.x],
                       second = mesh.texcoords[t.z] - mesh.texcoords[t.x];
      sign = first.y * second.x - first.x * second.y;
      if (sign == 0.0) sign = -sign_of(i);
    }
    mirrored.push_back(sign < 0.0);
  }
  return mirrored;
}

}  // namespace penumbra::gltf
