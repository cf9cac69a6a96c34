#include "scenes/pbrt/loop_subdivision.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace penumbra::pbrt {
namespace {

constexpr std::size_t kMostSubdivided = std::size_t{1} << 26;

using Edge = std::pair<std::uint32_t, std::uint32_t>;
Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

struct Sides {
  std::array<std::uint32_t, 2> opposite{};
  int count = 0;
};
using Edges = std::map<Edge, Sides>;

Expected<Edges> edges_of(const Mesh& mesh) {
  Edges edges;
  for (const glm::uvec3& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      Sides& sides = edges[edge_of(a, b)];
      if (sides.count == 2)
        return fail(fmt::format("the edge between the points {} and {} has more than two triangles", a, b));
      sides.opposite[std::size_t(sides.count++)] = t[(i + 2) % 3];
    }
  return edges;
}

/// The sums over a vertex's neighbours; for a boundary vertex over its two boundary neighbours.
struct Neighbours {
  glm::dvec3 sum{0.0}, boundary_sum{0.0};
  int count = 0;
  bool boundary = false;
};
std::vector<Neighbours> neighbours_of(const Mesh& mesh, const Edges& edges) {
  std::vector<Neighbours> all(mesh.positions.size());
  for (const auto& [edge, sides] : edges)
    for (const auto& [at, other] : {edge, Edge{edge.second, edge.first}}) {
      all[at].sum += mesh.positions[other];
      ++all[at].count;
      if (sides.count == 2) continue;
      all[at].boundary = true;
      all[at].boundary_sum += mesh.positions[other];
    }
  return all;
}

/// Warren's weight of a neighbour.
double beta_of(int count) { return count == 3 ? 3.0 / 16.0 : 3.0 / (8.0 * count); }

Expected<Mesh> refined(const Mesh& mesh) {
  const auto edges = edges_of(mesh);
  if (!edges) return std::unexpected(edges.error());
  const std::vector<Neighbours> around = neighbours_of(mesh, *edges);
  Mesh fine;
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Neighbours& n = around[i];
    const glm::dvec3& p = mesh.positions[i];
    if (n.count == 0)
      fine.positions.push_back(p);
    else if (n.boundary)
      fine.positions.push_back(0.75 * p + 0.125 * n.boundary_sum);
    else
      fine.positions.push_back((1.0 - n.count * beta_of(n.count)) * p + beta_of(n.count) * n.sum);
  }
  std::map<Edge, std::uint32_t> middles;
  for (const auto& [edge, sides] : *edges) {
    middles[edge] = std::uint32_t(fine.positions.size());
    const glm::dvec3 ends = mesh.positions[edge.first] + mesh.positions[edge.second];
    fine.positions.push_back(sides.count == 1 ? 0.5 * ends
                                              : 0.375 * ends + 0.125 * (mesh.positions[sides.opposite[0]] +
                                                                        mesh.positions[sides.opposite[1]]));
  }
  for (const glm::uvec3& t : mesh.triangles) {
    const std::uint32_t xy = middles[edge_of(t.x, t.y)], yz = middles[edge_of(t.y, t.z)],
                        zx = middles[edge_of(t.z, t.x)];
    for (const glm::uvec3& part :
         {glm::uvec3(t.x, xy, zx), glm::uvec3(xy, t.y, yz), glm::uvec3(zx, yz, t.z), glm::uvec3(xy, yz, zx)})
      fine.triangles.push_back(part);
  }
  return fine;
}

}  // namespace

Expected<Mesh> loop_subdivided(const Mesh& mesh, int levels) {
  Mesh fine;
  fine.positions = mesh.positions;
  fine.triangles = mesh.triangles;
  for (int level = 0; level < levels; ++level) {
    if (fine.triangles.size() > kMostSubdivided / 4)
      return fail(
          fmt::format("{} levels of subdivision make more than {} triangles", levels, kMostSubdivided));
    auto next = refined(fine);
    if (!next) return next;
    fine = std::move(*next);
  }
  const auto edges = edges_of(fine);
  if (!edges) return std::unexpected(edges.error());
  const std::vector<Neighbours> around = neighbours_of(fine, *edges);
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Neighbours& n = around[i];
    glm::dvec3& p = fine.positions[i];
    if (n.count == 0) continue;
    if (n.boundary) {
      p = (4.0 * p + n.boundary_sum) / 6.0;
      continue;
    }
    const double gamma = 1.0 / (n.count + 3.0 / (8.0 * beta_of(n.count)));
    p = (1.0 - n.count * gamma) * p + gamma * n.sum;
  }
  return fine;
}

}  // namespace penumbra::pbrt
