// The light of polygons on a surface, in 113-bit arithmetic and by another method than
// kernels/polygon/polygon_light.h: outlines are cut into triangles, each is clipped at the horizon, and their
// contributions are summed.
#pragma once

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

using Loop = std::vector<Quad3>;  ///< corners; outer loops are counter-clockwise seen from the front

/// The part of a convex loop with n.p >= 0 (Sutherland and Hodgman 1974).
Loop clip(const Loop& loop, const Quad3& n);

/// The solid angle of a triangle seen from the origin, 0 to 2 pi (Van Oosterom and Strackee 1983).
Quad solid_angle(const Quad3& a, const Quad3& b, const Quad3& c);

/// The integral of n.u over the directions u from the origin to the part of the convex loop above the
/// horizon; positive if the loop is clockwise seen from the origin (Lambert 1760).
Quad projected_solid_angle(const Loop& convex, const Quad3& n);

/// The integral of max(0, n.u) over the directions u from x to the polygon, negative if x sees its back.
Quad irradiance(const std::vector<Loop>& loops, const Quad3& x, const Quad3& n);

/// (e + 2) / (2 pi) times the integral of max(0, w.u)^e max(0, n.u), with the same sign, for integers e:
/// Arvo's (1995) recurrence for the double-axis moments of triangles clipped by both planes.
Quad lobe(const std::vector<Loop>& loops, const Quad3& x, const Quad3& n, const Quad3& w, int exponent);

}  // namespace penumbra::stress
