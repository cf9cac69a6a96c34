// Curves of pbrt as uniform cubic B-splines.
#pragma once

#include <span>
#include <vector>

#include "scenes/curve_reader.h"

namespace penumbra::pbrt {

struct CurveKind {
  bool bezier = true;                            ///< else a uniform B-spline
  int degree = 3;                                ///< or 2
  double first_radius = 0.5, last_radius = 0.5;  ///< at its ends, linear between them
};

/// The same curve; of Bezier pieces, and of degree 2, each by itself. There are as many points as pieces
/// need.
std::vector<Curve> bspline_curves(std::span<const glm::dvec3> points, const CurveKind& kind);

}  // namespace penumbra::pbrt
