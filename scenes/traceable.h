// Limits of geometry that rays in single precision can intersect.
#pragma once

#include <cstddef>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// The largest coordinate of a vertex or an instance along each axis: intersection with a triangle multiplies
/// three distances.
constexpr double kFarthest = 1e12;
/// The largest coordinate of a sphere, disk or cylinder, including its radius: intersection multiplies two
/// distances.
constexpr double kFarthestQuadric = 1e18;
/// Limits of twice the area of a triangle: its square must not overflow or underflow.
constexpr double kLargestCross = 1.8e19, kSmallestCross = 1.1e-19;
/// The smallest radius, for the same reason.
constexpr double kSmallestRadius = 1.1e-19;

/// |(b - a) x (c - a)|.
double triangle_cross(const Mesh& mesh, const glm::uvec3& triangle);

/// Checks that every vertex is near enough and that no triangle is too large or too small. Errors name the
/// first vertex or triangle that fails.
Expected<void> check_vertices(const Mesh& mesh);
Expected<void> check_faces(const Mesh& mesh);

/// Whether a point of a curve is near and thin enough.
bool is_traceable(const ControlPoint& point);

/// The same for any shape. Errors: a shape that is too far away, too large or too small.
Expected<void> check_traceable(const Geometry& geometry);

}  // namespace penumbra
