#include "scenes/mikktspace.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "scenes/scene_description.h"

namespace penumbra {
namespace {

constexpr int kNone = -1;
constexpr int after(int corner) { return (corner + 1) % 3; }
constexpr int before(int corner) { return (corner + 2) % 3; }

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : glm::dvec3(0.0);
}

class Tangents {
 public:
  explicit Tangents(const Mesh& mesh) : mesh_(mesh), faces_(mesh.triangles.size()) {
    for (std::size_t t = 0; t < faces_.size(); ++t) set_up(t);
    weld();
    join();
  }

  std::vector<std::array<glm::vec4, 3>> make() {
    for (std::size_t t = 0; t < faces_.size(); ++t)
      for (int c = 0; c < 3; ++c)
        if (!faces_[t].is_point && !faces_[t].follows && faces_[t].group[std::size_t(c)] == kNone) grow(t, c);
    std::vector<glm::dvec3> sums(groups_, glm::dvec3(0.0));
    for (std::size_t t = 0; t < faces_.size(); ++t)
      for (int c = 0; c < 3; ++c)
        if (const int group = faces_[t].group[std::size_t(c)]; group != kNone && !faces_[t].follows)
          sums[std::size_t(group)] += share(t, c);
    std::vector<std::array<glm::vec4, 3>> result(faces_.size());
    std::vector<glm::vec4> of_vertex(vertices_, glm::vec4(0.0f));
    for (std::size_t t = 0; t < faces_.size(); ++t)
      for (int c = 0; c < 3; ++c) {
        glm::vec4& tangent = result[t][std::size_t(c)];
        const int group = faces_[t].group[std::size_t(c)];
        const glm::dvec3 sum = group == kNone ? glm::dvec3(0.0) : unit_or_zero(sums[std::size_t(group)]);
        tangent = glm::vec4(glm::vec3(sum), faces_[t].keeps_orientation ? 1.0f : -1.0f);
        glm::vec4& known = of_vertex[faces_[t].vertex[std::size_t(c)]];
        if (group != kNone && known == glm::vec4(0.0f)) known = tangent;
      }
    // A triangle that is a line or a point takes what others have at its vertices.
    for (std::size_t t = 0; t < faces_.size(); ++t)
      for (std::size_t c = 0; faces_[t].is_point && c < 3; ++c) result[t][c] = of_vertex[faces_[t].vertex[c]];
    return result;
  }

 private:
  struct Face {
    std::array<std::uint32_t, 3> vertex{};              ///< welded
    std::array<int, 3> neighbour{kNone, kNone, kNone};  ///< across the edge from each corner to the next
    std::array<int, 3> group{kNone, kNone, kNone};
    glm::dvec3 u{0.0}, normal{0.0};
    bool keeps_orientation = true;
    bool follows = false;   ///< its texture coordinates have no area
    bool is_point = false;  ///< two of its corners are in the same place
  };

  [[nodiscard]] const glm::dvec3& position(std::size_t t, int corner) const {
    return mesh_.positions[mesh_.triangles[t][corner]];
  }
  [[nodiscard]] glm::dvec3 normal(std::size_t t, int corner) const {
    return mesh_.normals.empty() ? faces_[t].normal
                                 : unit_or_zero(glm::dvec3(mesh_.normals[mesh_.triangles[t][corner]]));
  }

  void set_up(std::size_t t) {
    Face& face = faces_[t];
    const glm::dvec3 e1 = position(t, 1) - position(t, 0), e2 = position(t, 2) - position(t, 0);
    face.is_point = e1 == glm::dvec3(0.0) || e2 == glm::dvec3(0.0) || e1 == e2;
    face.normal = unit_or_zero(glm::cross(e1, e2));
    const auto uv = [&](int corner) { return glm::dvec2(mesh_.texcoords[mesh_.triangles[t][corner]]); };
    const glm::dvec2 d1 = uv(1) - uv(0), d2 = uv(2) - uv(0);
    const double area = d1.x * d2.y - d1.y * d2.x;
    face.keeps_orientation = area > 0.0;
    const glm::dvec3 u = d2.y * e1 - d1.y * e2, v = d1.x * e2 - d2.x * e1;
    face.follows = !(std::abs(area) > double(std::numeric_limits<float>::min())) || u == glm::dvec3(0.0) ||
                   v == glm::dvec3(0.0);
    face.u = unit_or_zero(area > 0.0 ? u : -u);
  }

  /// Numbers the vertices: corners with equal position, normal and texture coordinates have the same.
  void weld() {
    using Values = std::tuple<double, double, double, float, float, double, double, double>;
    const auto values = [&](std::uint32_t corner) {
      const std::size_t t = corner / 3;
      const int c = int(corner % 3);
      const glm::dvec3& p = position(t, c);
      const glm::vec2& uv = mesh_.texcoords[mesh_.triangles[t][c]];
      const glm::dvec3 n =
          mesh_.normals.empty() ? faces_[t].normal : glm::dvec3(mesh_.normals[mesh_.triangles[t][c]]);
      return Values{p.x, p.y, p.z, uv.x, uv.y, n.x, n.y, n.z};
    };
    std::vector<std::uint32_t> order(3 * faces_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return values(a) < values(b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i == 0 || values(order[i - 1]) < values(order[i])) ++vertices_;
      faces_[order[i] / 3].vertex[order[i] % 3] = std::uint32_t(vertices_ - 1);
    }
  }

  /// Finds the neighbours: pairs of triangles that run along an edge in opposite directions.
  void join() {
    struct Edge {
      std::uint32_t low, high, face;
      int corner;
      bool rises;
      [[nodiscard]] auto key() const { return std::tie(low, high, face); }
    };
    std::vector<Edge> edges;
    for (std::uint32_t t = 0; t < faces_.size(); ++t)
      for (int c = 0; c < 3 && !faces_[t].is_point; ++c) {
        const std::uint32_t a = faces_[t].vertex[std::size_t(c)], b = faces_[t].vertex[std::size_t(after(c))];
        edges.push_back({std::min(a, b), std::max(a, b), t, c, a < b});
      }
    std::ranges::sort(edges, [](const Edge& a, const Edge& b) { return a.key() < b.key(); });
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Edge& a = edges[i];
      int& neighbour = faces_[a.face].neighbour[std::size_t(a.corner)];
      for (std::size_t j = i + 1;
           neighbour == kNone && j < edges.size() && edges[j].low == a.low && edges[j].high == a.high; ++j) {
        const Edge& b = edges[j];
        int& other = faces_[b.face].neighbour[std::size_t(b.corner)];
        if (other != kNone || a.rises == b.rises) continue;
        neighbour = int(b.face);
        other = int(a.face);
      }
    }
  }

  /// Makes a group of the triangles around a corner that share a tangent there. A triangle without an
  /// orientation takes that of the first group that it comes to.
  void grow(std::size_t first, int corner) {
    const int group = int(groups_++);
    const std::uint32_t vertex = faces_[first].vertex[std::size_t(corner)];
    const bool keeps = faces_[first].keeps_orientation;
    std::vector<int> next{int(first)};
    while (!next.empty()) {
      const int t = next.back();
      next.pop_back();
      if (t == kNone) continue;
      Face& face = faces_[std::size_t(t)];
      const auto c = std::size_t(std::ranges::find(face.vertex, vertex) - face.vertex.begin());
      if (face.group[c] != kNone) continue;
      if (face.follows && std::ranges::all_of(face.group, [](int g) { return g == kNone; }))
        face.keeps_orientation = keeps;
      if (face.keeps_orientation != keeps) continue;
      face.group[c] = group;
      next.push_back(face.neighbour[std::size_t(before(int(c)))]);
      next.push_back(face.neighbour[c]);
    }
  }

  /// What a triangle adds to the tangent at a corner: its direction of u, weighted by its angle.
  [[nodiscard]] glm::dvec3 share(std::size_t t, int corner) const {
    const glm::dvec3 n = normal(t, corner), &p = position(t, corner);
    const auto in_plane = [&](const glm::dvec3& v) { return unit_or_zero(v - glm::dot(n, v) * n); };
    const double cosine =
        glm::dot(in_plane(position(t, after(corner)) - p), in_plane(position(t, before(corner)) - p));
    return std::acos(std::clamp(cosine, -1.0, 1.0)) * in_plane(faces_[t].u);
  }

  const Mesh& mesh_;
  std::vector<Face> faces_;
  std::size_t vertices_ = 0, groups_ = 0;
};

}  // namespace

std::vector<std::array<glm::vec4, 3>> mikktspace_tangents(const Mesh& mesh) { return Tangents(mesh).make(); }

}  // namespace penumbra
