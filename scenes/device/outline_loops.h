// From the edges of a planar figure to its loops.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace penumbra {

/// Two-dimensional coordinates in a plane; counter-clockwise is as its normal sees it. Keeps a reference to
/// the vertices.
class Plane {
 public:
  Plane(const std::vector<glm::dvec3>& vertices, const glm::dvec3& origin, const glm::dvec3& normal);
  [[nodiscard]] glm::dvec2 at(int vertex) const {
    const glm::dvec3 p = vertices_[std::size_t(vertex)] - origin_;
    return {glm::dot(p, x_), glm::dot(p, y_)};
  }

 private:
  const std::vector<glm::dvec3>& vertices_;
  glm::dvec3 origin_, x_, y_;
};

/// From a vertex to another one, with the figure's inside to its left.
struct OutlineEdge {
  int from, to;
};

/// Distinct vertices, the first one not repeated at the end.
using Loop = std::vector<int>;

/// Chains edges into loops, none of which visits a vertex twice; where loops touch they do not cross, if the
/// edges are those of a planar figure. In each vertex as many edges end as start. Time: n log n.
std::vector<Loop> chain_edges(const std::vector<OutlineEdge>& edges, const Plane& plane);

/// Without the corners within straight sides, where that moves no point of the loops by more than
/// `tolerance`, and without loops of no width; as they were, if that would change the area by more than 1e-5
/// of it.
std::vector<Loop> simplify_loops(const std::vector<Loop>& loops, const Plane& plane, double tolerance);

}  // namespace penumbra
