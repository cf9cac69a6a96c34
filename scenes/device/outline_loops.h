// Turns the edges of a planar figure into closed loops.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace penumbra {

/// Two-dimensional coordinates in a plane. Counter-clockwise is as seen from the side to which its normal
/// points. Keeps a reference to the vertices.
class OutlinePlane {
 public:
  OutlinePlane(const std::vector<glm::dvec3>& vertices, const glm::dvec3& origin, const glm::dvec3& normal);
  [[nodiscard]] glm::dvec2 at(int vertex) const {
    const glm::dvec3 p = vertices_[std::size_t(vertex)] - origin_;
    return {glm::dot(p, x_), glm::dot(p, y_)};
  }

 private:
  const std::vector<glm::dvec3>& vertices_;
  glm::dvec3 origin_, x_, y_;
};

/// A directed edge between two vertices. The inside of the figure is to its left.
struct OutlineEdge {
  int from, to;
};

/// Distinct vertices; the first one is not repeated at the end.
using Loop = std::vector<int>;

/// Chains edges into loops, none of which visits a vertex twice. Loops that touch do not cross if the edges
/// belong to a planar figure. At each vertex as many edges must end as start. Time: O(n log n).
std::vector<Loop> chain_edges(const std::vector<OutlineEdge>& edges, const OutlinePlane& plane);

/// Removes corners in the middle of straight sides if that moves no point of the loops by more than
/// `tolerance`, and removes loops of zero width. Returns the loops unchanged if this would change the area by
/// more than a fraction of 1e-5.
std::vector<Loop> simplify_loops(const std::vector<Loop>& loops, const OutlinePlane& plane, double tolerance);

}  // namespace penumbra
