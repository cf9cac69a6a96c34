// What polygon lights add to a surface, in 113 bits, by other routes than kernels/polygon/polygon_light.h:
// outlines are cut into triangles, each is clipped at the horizon and summed up by itself.
#pragma once

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

using Loop = std::vector<Quad3>;  ///< corners; outer loops counter-clockwise seen from the front

/// The part of a convex loop with n.p >= 0 (Sutherland and Hodgman 1974).
Loop clip(const Loop& loop, const Quad3& n);

/// Of a triangle seen from the origin, 0 to 2 pi (Van Oosterom and Strackee 1983).
Quad solid_angle(const Quad3& a, const Quad3& b, const Quad3& c);

/// The integral of n.u over the directions u to the part of the convex loop above the horizon, seen from the
/// origin; positive where it is clockwise about them (Lambert 1760).
Quad projected_solid_angle(const Loop& convex, const Quad3& n);

/// The integral of max(0, n.u) over the directions u from x to the polygon, negative if x sees its back.
Quad irradiance(const std::vector<Loop>& loops, const Quad3& x, const Quad3& n);

/// (e + 2) / (2 pi) times the integral of max(0, w.u)^e max(0, n.u), with the same sign, for integers e:
/// Arvo's (1995) recurrence for the double-axis moments of triangles clipped by both planes.
Quad lobe(const std::vector<Loop>& loops, const Quad3& x, const Quad3& n, const Quad3& w, int exponent);

}  // namespace penumbra::stress
