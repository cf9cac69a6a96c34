// Sampling maps of triangles and rectangles by solid angle, in 113 bits: not by closed forms, as in the
// kernels, but by bisection of the solid angle on either side.
#pragma once

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

/// The direction to the triangle seen from the origin: the arc from b to a point of the side from a to c cuts
/// off the part u of its solid angle, next to a; along that arc the part v of the rest is nearer to b.
Quad3 sample_triangle(const Quad3& a, const Quad3& b, const Quad3& c, Quad u, Quad v);

/// Solid angle of the rectangle of a corner and those next and previous to it.
Quad rectangle_solid_angle(const Quad3& corner, const Quad3& next, const Quad3& previous);

/// The direction to the rectangle: a parallel to the side towards `previous` cuts off the part u of the solid
/// angle, next to the corner; along it the sine of the latitude is uniform (Archimedes).
Quad3 sample_rectangle(const Quad3& corner, const Quad3& next, const Quad3& previous, Quad u, Quad v);

}  // namespace penumbra::stress
