// Planar lights from their triangles: what several triangles enclose, by its outline.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "kernels/math/vec3.h"

namespace penumbra {

/// The front sees the vertices counter-clockwise.
struct LightTriangle {
  vec3 p0, p1, p2;
};

struct Outline {
  /// Closed loops of corners, the first not repeated at the end. Seen from the front, the inside is to
  /// the left of every edge: outer loops run counter-clockwise, holes clockwise. Every edge of a triangle
  /// that no other triangle of the outline has in the opposite direction is on one of them, as often as
  /// triangles have it, or on a straight side in place of several. Loops may touch in a corner; none visits
  /// one twice.
  std::vector<std::vector<vec3>> loops;
  std::vector<int> triangles;  ///< indices of the triangles inside, ascending
  double area = 0;             ///< of the triangles together
  float size = 0;              ///< upper bound of the distance between two corners
  glm::dvec3 normal{0};        ///< of its front, a unit vector; 0 without an area
  /// If two triangles make a rectangle: a corner, the next and the previous one; the edges to them are
  /// perpendicular, and the fourth corner completes the parallelogram, within 1e-5 of the shorter one.
  std::optional<std::array<vec3, 3>> rectangle;
};

struct Outlines {
  std::vector<Outline> outlines;  ///< by their first triangles
  std::vector<int> duplicates;  ///< triangles with the corners and the front of an earlier one, ascending: in
                                ///< no outline
};

/// Merges triangles that share edges (in opposite directions, their ends bit for bit the same), lie in one
/// plane and face the same way. In one plane are triangles whose vertices keep within 1e-5 of their common
/// extent, or within the rounding of their coordinates, of it: the integral of light over a slightly bent
/// patch still is that over its outline exactly (Lambert's edges of inner sides cancel whatever the bend);
/// only a receiver that close to the plane may see some of its triangles from behind. Corners in the middle
/// of straight sides are left out where that moves no point of the outline by more than the rounding of its
/// coordinates, and changes its area by at most 1e-5 of it. Positions are finite; a triangle without area
/// stays by itself, and so do neighbours across an edge that more than 32 triangles have. Time: n log n.
Outlines merge_coplanar(std::span<const LightTriangle> triangles);

}  // namespace penumbra
