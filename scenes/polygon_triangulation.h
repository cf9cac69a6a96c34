// Polygons of mesh files as triangles.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// Faces with more corners than this are cut into triangles only if they are convex: the work grows with the
/// square.
constexpr std::size_t kMaxConcaveCorners = 1 << 14;

struct Triangulation {
  std::vector<glm::uvec3> triangles;  ///< numbers of corners, wound as the polygon is
  /// The largest distance of a corner from the polygon's plane, relative to the polygon's extent.
  double deviation = 0.0;
  /// The outline crosses itself, folds back on itself or runs round more than once, so that it has no inside.
  /// The triangles are a fan about the first corner all the same.
  bool tangled = false;
};

/// Cuts a polygon of 3 or more finite corners into triangles:
///  - a convex one, and one without area, as a fan about its first corner;
///  - any other by clipping ears (Meisters 1975) in its plane, the one of Newell's normal (Sutherland et al.
///    1974). Corners on a straight edge become corners of triangles with area; an outline may touch itself,
///    as that of a polygon with a hole and a bridge to it does.
/// The triangles of a flat polygon have its area together. Errors: too many corners for a concave one.
Expected<Triangulation> triangulate(std::span<const glm::dvec3> corners);

}  // namespace penumbra
