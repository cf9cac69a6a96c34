// Cuts the polygons of mesh files into triangles.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "kernels/host/error.h"

namespace penumbra {

/// Faces with more corners than this are only cut if they are convex, because ear clipping takes quadratic
/// time.
constexpr std::size_t kMaxConcaveCorners = 1 << 14;

struct Triangulation {
  std::vector<glm::uvec3> triangles;  ///< indices of corners, wound like the polygon
  /// The largest distance of a corner from the polygon's plane, relative to the polygon's extent.
  double deviation = 0.0;
  /// The outline crosses itself, folds back on itself or runs round more than once, so it has no well-defined
  /// inside. The triangles are then a fan about the first corner.
  bool tangled = false;
};

/// Cuts a polygon of 3 or more finite corners into triangles:
///   - a convex polygon, or one without area, becomes a fan about its first corner;
///   - any other is cut by ear clipping (Meisters 1975) in the plane of Newell's normal (Sutherland et al.
///     1974).
/// A corner on a straight edge becomes a corner of triangles that have area. An outline may touch itself, for
/// example that of a polygon whose hole is joined by a bridge. The areas of the triangles of a flat polygon
/// sum to its area. Errors: too many corners for a concave polygon.
Expected<Triangulation> triangulate(std::span<const glm::dvec3> corners);

}  // namespace penumbra
