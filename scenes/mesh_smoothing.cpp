#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>

#include "scenes/mesh_tools.h"

namespace penumbra {
namespace {

/// The largest number of normals at one point; beyond it every face has its own. It limits the time for
/// points with very many faces.
constexpr std::size_t kMostNormals = 256;

struct FaceCorner {
  std::uint32_t triangle, corner;
};

/// Faces around a point that share a normal.
struct Cluster {
  glm::dvec3 first, sum;
};

struct Face {
  glm::dvec3 normal;
  double angles[3];
};

Face face_of(const Mesh& mesh, const glm::uvec3& t) {
  Face face{};
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3& p = mesh.positions[t[i]];
    const glm::dvec3 u = glm::normalize(mesh.positions[t[(i + 1) % 3]] - p),
                     v = glm::normalize(mesh.positions[t[(i + 2) % 3]] - p);
    const glm::dvec3 across = glm::cross(u, v);
    face.angles[i] = std::atan2(glm::length(across), glm::dot(u, v));
    if (i == 0) face.normal = glm::normalize(across);
  }
  return face;
}

}  // namespace

void smooth_up_to(Mesh& mesh, double degrees) {
  const double least_cosine = std::cos(degrees * std::numbers::pi / 180) - 1e-9;
  using Place = std::tuple<double, double, double>;
  std::map<Place, std::vector<FaceCorner>> corners;
  std::vector<Face> faces;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    faces.push_back(face_of(mesh, mesh.triangles[t]));
    for (std::uint32_t i = 0; i < 3; ++i) {
      const glm::dvec3& p = mesh.positions[mesh.triangles[t][int(i)]];
      corners[{p.x, p.y, p.z}].push_back({t, i});
    }
  }
  Mesh result;
  result.triangles = mesh.triangles;
  result.face_colours = mesh.face_colours;
  result.tangents = mesh.tangents;
  const auto add_vertex = [&](std::uint32_t from, const glm::dvec3& normal) {
    result.positions.push_back(mesh.positions[from]);
    result.normals.emplace_back(normal);
    if (!mesh.texcoords.empty()) result.texcoords.push_back(mesh.texcoords[from]);
    if (!mesh.colours.empty()) result.colours.push_back(mesh.colours[from]);
    return std::uint32_t(result.positions.size() - 1);
  };
  for (const auto& [place, about] : corners) {
    std::vector<Cluster> clusters;
    std::vector<std::size_t> cluster_of;
    for (const FaceCorner& each : about) {
      const glm::dvec3& n = faces[each.triangle].normal;
      std::size_t c = 0;
      while (c < std::min(clusters.size(), kMostNormals) && !(glm::dot(clusters[c].first, n) >= least_cosine))
        ++c;
      if (c == std::min(clusters.size(), kMostNormals)) {
        c = clusters.size();
        clusters.push_back({n, glm::dvec3(0.0)});
      }
      clusters[c].sum += faces[each.triangle].angles[each.corner] * n;
      cluster_of.push_back(c);
    }
    std::map<std::pair<std::uint32_t, std::size_t>, std::uint32_t> made;
    for (std::size_t k = 0; k < about.size(); ++k) {
      std::uint32_t& corner = result.triangles[about[k].triangle][int(about[k].corner)];
      const Cluster& cluster = clusters[cluster_of[k]];
      const auto [vertex, is_new] = made.try_emplace({corner, cluster_of[k]}, 0);
      const double length = glm::length(cluster.sum);
      if (is_new) vertex->second = add_vertex(corner, length > 1e-12 ? cluster.sum / length : cluster.first);
      corner = vertex->second;
    }
  }
  mesh = std::move(result);
  drop_face_normals(mesh);
}

}  // namespace penumbra
