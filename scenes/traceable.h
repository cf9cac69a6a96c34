// What rays in single precision can meet.
#pragma once

#include <cstddef>

#include "kernels/host/error.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Of a vertex or an instance, along each axis: intersections with triangles multiply three distances.
constexpr double kFarthest = 1e12;
/// Of spheres, disks and cylinders, with their size: theirs multiply two.
constexpr double kFarthestQuadric = 1e18;
/// Twice the area of a triangle: squares of it are numbers.
constexpr double kLargestCross = 1.8e19, kSmallestCross = 1.1e-19;
/// A radius, likewise.
constexpr double kSmallestRadius = 1.1e-19;

/// |(b - a) x (c - a)|.
double triangle_cross(const Mesh& mesh, const glm::uvec3& triangle);

/// Every vertex is near enough; every triangle neither too large nor too small. Errors name the first that is
/// not.
Expected<void> check_vertices(const Mesh& mesh);
Expected<void> check_faces(const Mesh& mesh);

/// The same of any shape. Errors: one that is too far away, too large or too small.
Expected<void> check_traceable(const Geometry& geometry);

}  // namespace penumbra
