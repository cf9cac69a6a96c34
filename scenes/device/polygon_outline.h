// Finds planar polygon lights: merges coplanar triangles and computes the outline of the result.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "kernels/math/vec3.h"

namespace penumbra {

/// A triangle of a light. Seen from the front, its vertices are counter-clockwise.
struct LightTriangle {
  vec3 p0, p1, p2;
};

struct Outline {
  /// Closed loops of corners; the first one is not repeated at the end. Seen from the front, the inside is to
  /// the left of every edge: outer loops run counter-clockwise, holes clockwise. The loops contain every
  /// triangle edge that no other triangle of the outline has in the opposite direction, as often as triangles
  /// have it; several edges on a straight side may be replaced by one. Loops may touch at a corner, but none
  /// visits a corner twice.
  std::vector<std::vector<vec3>> loops;
  std::vector<int> triangles;  ///< indices of the triangles inside, ascending
  double area = 0;             ///< total area of the triangles
  float size = 0;              ///< upper bound of the distance between two corners
  glm::dvec3 normal{0};        ///< unit normal of the front; 0 if there is no area
  /// If two triangles form a rectangle: a corner, the next one and the previous one. The edges to them are
  /// perpendicular, and the fourth corner completes the parallelogram, within 1e-5 of the shorter edge.
  std::optional<std::array<vec3, 3>> rectangle;
};

struct Outlines {
  std::vector<Outline> outlines;  ///< ordered by their first triangles
  /// Triangles with the same corners and front as an earlier one, ascending; they belong to no outline.
  std::vector<int> duplicates;
};

/// Merges triangles that share edges (in opposite directions, with bitwise identical ends), lie in one plane
/// and face the same way. Triangles lie in one plane if the distance of all vertices from it is within 1e-5
/// of their common extent, or within the rounding of their coordinates. The light of a slightly bent patch is
/// still exactly the integral over its outline: in Lambert's formula the inner edges cancel, whatever the
/// bend. Only a receiver that close to the plane may see some of the triangles from behind. Corners in the
/// middle of straight sides are removed if that moves no point of the outline by more than the rounding of
/// its coordinates and changes its area by at most a fraction of 1e-5. Positions must be finite. A triangle
/// without area is not merged, nor are neighbours across an edge that more than 32 triangles share. Time: O(n
/// log n).
Outlines merge_coplanar(std::span<const LightTriangle> triangles);

}  // namespace penumbra
