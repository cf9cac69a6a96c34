// The maps for sampling triangles and rectangles by solid angle, in 113-bit arithmetic. Unlike the kernels
// they use no closed forms, but bisection on the solid angle.
#pragma once

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

/// The sampled direction to the triangle seen from the origin. The arc from b to a point of the side from a
/// to c cuts off the fraction u of the solid angle on a's side. The direction lies on that arc; the fraction
/// v of the remaining measure is nearer to b.
Quad3 sample_triangle(const Quad3& a, const Quad3& b, const Quad3& c, Quad u, Quad v);

/// The solid angle of a rectangle given by a corner and its next and previous corner.
Quad rectangle_solid_angle(const Quad3& corner, const Quad3& next, const Quad3& previous);

/// The sampled direction to the rectangle. A line parallel to the side towards `previous` cuts off the
/// fraction u of the solid angle on the corner's side. Along that line the sine of the latitude is uniform
/// (Archimedes).
Quad3 sample_rectangle(const Quad3& corner, const Quad3& next, const Quad3& previous, Quad u, Quad v);

}  // namespace penumbra::stress
