// The contribution of polygon lights to a surface, computed independently of kernels/polygon/polygon_light.h:
// Lambert's and Arvo's closed forms for clipped triangles in 113 bits, and quadrature over the light's area.
#pragma once

#include <functional>
#include <vector>

#include "tests/kernels/quad_vector.h"

namespace penumbra {

/// A point that looks at a light: n is its unit normal, w the unit axis of its Phong lobe.
struct QuadReceiver {
  Quad3 x, n, w;
};

/// The corners of an outline's loops: outer ones counter-clockwise seen from the front.
using QuadLoop = std::vector<Quad3>;
using QuadLoops = std::vector<QuadLoop>;

QuadLoops quad(const std::vector<std::vector<vec3>>& loops);

/// The part of a loop of vertices relative to the receiver with n.p >= 0 (Sutherland and Hodgman 1974).
QuadLoop clip(const QuadLoop& loop, const Quad3& n);

/// The integral of max(0, n.u) over the directions u to a planar polygon, negative if the receiver sees its
/// back.
Quad oracle_irradiance(const QuadLoops& loops, const QuadReceiver& receiver);

/// (e + 2) / (2 pi) times the integral of max(0, w.u)^e max(0, n.u), with the same sign: Arvo's (1995)
/// recurrence for the double-axis moments of triangles clipped by both planes.
Quad oracle_lobe(const QuadLoops& loops, const QuadReceiver& receiver, int exponent);

/// The integral of f(u) max(0, n.u) over the unit directions u to a planar polygon by adaptive quadrature, to
/// some `tolerance`, with the same sign.
double quadrature(const QuadLoops& loops, const QuadReceiver& receiver,
                  const std::function<double(double x, double y, double z)>& f, double tolerance);

/// The same by adaptive quadrature over the area, for any exponent, to some `tolerance`. Not for receivers
/// close to the light.
double quadrature_lobe(const QuadLoops& loops, const QuadReceiver& receiver, double exponent,
                       double tolerance);

}  // namespace penumbra
