// Curves with a thickness as triangles.
#pragma once

#include <span>

#include "scenes/curve_reader.h"
#include "scenes/scene_description.h"

namespace penumbra {

/// Smooth, wound outwards, with Mitsuba 3's texture coordinates: u around the curve, from the direction
/// (-t.y, t.x, 0) of the tangent t on, v along all curves of the shape.
struct CurveMesh {
  Mesh mesh;
  int sides = 0;  ///< of the polygon in the place of a circle; as wide as that on average over directions
  double error = 0.0;  ///< bound on the distance to the surface, in radii
};

/// What a circle with the radius there leaves behind when it follows a uniform cubic B-spline, across its
/// tangent, open at both ends; radii are interpolated alike (Embree's round B-spline curves). Each curve has
/// at least four points. Errors: more triangles than are made.
Expected<CurveMesh> bspline_curve_mesh(std::span<const Curve> curves);

/// Spheres at all points and the cones that touch two in a row (Embree's round linear curves). At least two
/// points each. Errors: likewise.
Expected<CurveMesh> linear_curve_mesh(std::span<const Curve> curves);

}  // namespace penumbra
