// Converts pbrt's curves to uniform cubic B-splines.
#pragma once

#include <span>
#include <vector>

#include "scenes/curve_reader.h"

namespace penumbra::pbrt {

struct CurveKind {
  bool bezier = true;                            ///< false: a uniform B-spline
  int degree = 3;                                ///< or 2
  double first_radius = 0.5, last_radius = 0.5;  ///< radii at the two ends; linear between them
};

/// The same curve as cubic B-splines. Each Bezier segment becomes a curve of its own, and so does each
/// segment of degree 2. The number of points must be valid for the kind.
std::vector<Curve> bspline_curves(std::span<const glm::dvec3> points, const CurveKind& kind);

}  // namespace penumbra::pbrt
