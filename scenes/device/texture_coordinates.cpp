#include "scenes/device/texture_coordinates.h"

#include <algorithm>
#include <array>

#include "scenes/device/to_vec3.h"

namespace penumbra {
namespace {

bool same(const vec3& a, const vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

/// Whether both triangles have the same vertices in any order.
bool repeats(const Triangle& a, const Triangle& b) {
  const std::array corners{b.p0, b.p1, b.p2};
  const auto has = [&](const vec3& p) {
    return std::ranges::any_of(corners, [&](const vec3& q) { return same(p, q); });
  };
  return has(a.p0) && has(a.p1) && has(a.p2);
}

}  // namespace

VertexUvs vertex_uvs(const Mesh& mesh, const glm::uvec3& corner, bool flipped) {
  if (mesh.texcoords.empty()) return flipped ? VertexUvs{0, 0, 0, 1, 1, 0} : VertexUvs{0, 0, 1, 0, 0, 1};
  const glm::vec2 &a = mesh.texcoords[corner.x], &b = mesh.texcoords[corner.y], &c = mesh.texcoords[corner.z];
  return {a.x, a.y, b.x, b.y, c.x, c.y};
}

VertexTangents vertex_tangents(const Mesh& mesh, std::size_t triangle, const Triangle& record,
                               bool mirrors_maps, bool flipped) {
  VertexTangents result{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 1.0f};
  if (mesh.tangents.empty()) return result;
  const auto vector = [](const vec3& v) { return glm::dvec3(v.x, v.y, v.z); };
  const glm::dvec3 p0 = vector(record.p0), e1 = vector(record.p1) - p0, e2 = vector(record.p2) - p0;
  const glm::dmat3 to_edges = glm::inverse(glm::dmat3(e1, e2, glm::normalize(glm::cross(e1, e2))));
  const auto& corners = mesh.tangents[triangle];
  const auto along = [&](int corner) {
    const glm::dvec3 t(corners[std::size_t(corner)]);
    const double length = glm::length(t);
    return to_vec3(length > 0.0 ? to_edges * (t / length) : t);
  };
  result.t0 = along(0);
  result.t1 = along(flipped ? 2 : 1);
  result.t2 = along(flipped ? 1 : 2);
  // The front's normal is the other one.
  const float sign = corners[0].w + corners[1].w + corners[2].w;
  if (mirrors_maps && sign != 0.0f) result.hand = (sign < 0.0f) != flipped ? -1.0f : 1.0f;
  return result;
}

VertexColours triangle_colours(const Mesh& mesh, MeshAttribute attribute, const glm::uvec3& corner,
                               std::size_t triangle) {
  if (attribute == MeshAttribute::kVertexColour && !mesh.colours.empty())
    return {to_vec3(mesh.colours[corner.x]), to_vec3(mesh.colours[corner.y]),
            to_vec3(mesh.colours[corner.z])};
  if (attribute == MeshAttribute::kFaceColour && !mesh.face_colours.empty()) {
    const vec3 colour = to_vec3(mesh.face_colours[triangle]);
    return {colour, colour, colour};
  }
  return {};
}

std::vector<LightTriangles> light_triangles(std::span<const Triangle> triangles,
                                            std::span<const Quadric> quadrics, std::size_t lights) {
  std::vector<LightTriangles> result(lights, LightTriangles{-1, -1, -1});
  for (std::size_t i = 0; i < quadrics.size(); ++i)
    if (quadrics[i].light >= 0) result[std::size_t(quadrics[i].light)].quadric = int(i);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (triangles[i].light < 0) continue;
    LightTriangles& parts = result[std::size_t(triangles[i].light)];
    if (parts.first < 0)
      parts.first = parts.second = int(i);
    else if (parts.second == parts.first && !repeats(triangles[i], triangles[std::size_t(parts.first)]))
      parts.second = int(i);
  }
  return result;
}

}  // namespace penumbra
