#include "scenes/pbrt/mesh_faces.h"

#include <algorithm>
#include <map>
#include <span>

#include "scenes/mesh_tools.h"

namespace penumbra::pbrt {
namespace {

/// Appends a vertex of `from`, with all that belongs to it.
std::uint32_t copy_vertex(const Mesh& from, std::uint32_t vertex, Mesh& to) {
  to.positions.push_back(from.positions[vertex]);
  if (!from.normals.empty()) to.normals.push_back(from.normals[vertex]);
  if (!from.texcoords.empty()) to.texcoords.push_back(from.texcoords[vertex]);
  if (!from.colours.empty()) to.colours.push_back(from.colours[vertex]);
  return std::uint32_t(to.positions.size() - 1);
}

Mesh part_of(const Mesh& mesh, std::span<const std::size_t> triangles) {
  Mesh part;
  std::map<std::uint32_t, std::uint32_t> copied;
  for (const std::size_t index : triangles) {
    glm::uvec3 t = mesh.triangles[index];
    for (int i = 0; i < 3; ++i) {
      const auto [known, is_new] = copied.try_emplace(t[i]);
      if (is_new) known->second = copy_vertex(mesh, t[i], part);
      t[i] = known->second;
    }
    part.triangles.push_back(t);
    if (!mesh.face_colours.empty()) part.face_colours.push_back(mesh.face_colours[index]);
  }
  return part;
}

}  // namespace

void set_default_coordinates(Mesh& mesh, bool patches) {
  constexpr glm::vec2 kTriangle[] = {{0, 0}, {1, 0}, {1, 1}}, kSecond[] = {{0, 0}, {1, 1}, {0, 1}};
  mesh.texcoords.clear();
  Mesh apart;
  for (std::size_t index = 0; index < mesh.triangles.size(); ++index) {
    glm::uvec3& t = mesh.triangles[index];
    const auto& corners = patches && index % 2 == 1 ? kSecond : kTriangle;
    for (int i = 0; i < 3; ++i) {
      t[i] = copy_vertex(mesh, t[i], apart);
      apart.texcoords.push_back(corners[i]);
    }
  }
  mesh.positions = std::move(apart.positions);
  mesh.normals = std::move(apart.normals);
  mesh.texcoords = std::move(apart.texcoords);
  mesh.colours = std::move(apart.colours);
}

std::vector<FacesOfArea> split_by_face_area(const Mesh& mesh, std::size_t face_triangles) {
  std::vector<std::pair<double, std::size_t>> faces;  // area, first triangle
  for (std::size_t first = 0; first + face_triangles <= mesh.triangles.size(); first += face_triangles) {
    double area = 0;
    for (std::size_t i = first; i < first + face_triangles; ++i)
      area += 0.5 * glm::length(face_vector(mesh, mesh.triangles[i]));
    if (area > 0.0) faces.emplace_back(area, first);
  }
  std::ranges::sort(faces);
  std::vector<FacesOfArea> result;
  for (std::size_t from = 0, to = 0; from < faces.size(); from = to) {
    std::vector<std::size_t> triangles;
    double sum = 0;
    for (; to < faces.size() && faces[to].first <= (1.0 + kAreaSpread) * faces[from].first; ++to) {
      sum += faces[to].first;
      for (std::size_t i = 0; i < face_triangles; ++i) triangles.push_back(faces[to].second + i);
    }
    std::ranges::sort(triangles);
    result.push_back({part_of(mesh, triangles), sum / double(to - from)});
  }
  return result;
}

}  // namespace penumbra::pbrt
