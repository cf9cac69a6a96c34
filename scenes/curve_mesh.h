// Triangle meshes of curves that have a thickness.
#pragma once

#include <span>

#include "scenes/curve_reader.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// A smooth mesh whose front faces outwards. Its texture coordinates are Mitsuba 3's: u runs around the curve
/// and starts at the direction (-t.y, t.x, 0), where t is the tangent; v runs along all curves of the shape.
struct CurveMesh {
  Mesh mesh;
  /// Sides of the polygon that replaces the circular cross section; its width, averaged over directions, is
  /// the circle's.
  int sides = 0;
  double error = 0.0;  ///< upper bound on the distance to the exact surface, in radii
};

/// The surface swept by a circle across the tangent of a uniform cubic B-spline, open at both ends. Radii are
/// interpolated by the same spline (Embree's round B-spline curves). Each curve needs at least four points.
/// Errors: the mesh would exceed the limit on triangles.
Expected<CurveMesh> bspline_curve_mesh(std::span<const Curve> curves);

/// The surface of spheres at all points and of the cones that touch two consecutive spheres (Embree's round
/// linear curves). Each curve needs at least two points. Errors: the mesh would exceed the limit on
/// triangles.
Expected<CurveMesh> linear_curve_mesh(std::span<const Curve> curves);

/// Of curves of any form, as the ones above.
Expected<CurveMesh> curve_mesh(const Curves& curves);

}  // namespace penumbra
