#include "scenes/pbrt/mesh_faces.h"

#include <algorithm>
#include <span>
#include <utility>

#include "scenes/mesh_tools.h"

namespace penumbra::pbrt {

std::vector<TriangleOrigin> origins_of(std::span<const glm::uvec3> before,
                                       std::span<const glm::uvec3> after) {
  std::vector<TriangleOrigin> origins;
  origins.reserve(after.size());
  std::uint32_t index = 0;
  for (const glm::uvec3& t : after) {
    const glm::uvec3 turned(t.x, t.z, t.y);
    while (before[index] != t && before[index] != turned) ++index;
    origins.push_back({index, before[index] != t});
    ++index;
  }
  return origins;
}

void set_default_coordinates(Mesh& mesh, std::span<const TriangleOrigin> origins, bool patches) {
  constexpr glm::vec2 kTriangle[] = {{0, 0}, {1, 0}, {1, 1}}, kSecond[] = {{0, 0}, {1, 1}, {0, 1}};
  mesh.texcoords.clear();
  Mesh apart;
  for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
    glm::uvec3& t = mesh.triangles[index];
    const auto& corners = patches && origins[index].index % 2 == 1 ? kSecond : kTriangle;
    for (int i = 0; i < 3; ++i) {
      t[i] = copy_vertex(mesh, t[i], apart);
      apart.texcoords.push_back(corners[origins[index].turned && i > 0 ? 3 - i : i]);
    }
  }
  mesh.positions = std::move(apart.positions);
  mesh.normals = std::move(apart.normals);
  mesh.texcoords = std::move(apart.texcoords);
  mesh.colours = std::move(apart.colours);
}

std::vector<FacesOfArea> split_by_face_area(const Mesh& mesh, std::span<const TriangleOrigin> origins,
                                            std::size_t face_triangles) {
  struct Face {
    double area;
    std::size_t first, end;  ///< its triangles
  };
  std::vector<Face> faces;
  for (std::size_t first = 0, end = 0; first < mesh.triangles.size(); first = end) {
    double area = 0;
    for (; end < mesh.triangles.size() &&
           origins[end].index / face_triangles == origins[first].index / face_triangles;
         ++end)
      area += 0.5 * glm::length(face_vector(mesh, mesh.triangles[end]));
    faces.push_back({area, first, end});
  }
  std::ranges::sort(faces, {}, [](const Face& face) { return std::pair(face.area, face.first); });
  std::vector<FacesOfArea> result;
  for (std::size_t from = 0, to = 0; from < faces.size(); from = to) {
    std::vector<std::size_t> triangles;
    double sum = 0;
    for (; to < faces.size() && faces[to].area <= (1.0 + kAreaSpread) * faces[from].area; ++to) {
      sum += faces[to].area;
      for (std::size_t i = faces[to].first; i < faces[to].end; ++i) triangles.push_back(i);
    }
    std::ranges::sort(triangles);
    std::vector<TriangleOrigin> of_part;
    for (const std::size_t i : triangles) of_part.push_back(origins[i]);
    result.push_back({part_of(mesh, triangles), std::move(of_part), sum / double(to - from)});
  }
  return result;
}

}  // namespace penumbra::pbrt
