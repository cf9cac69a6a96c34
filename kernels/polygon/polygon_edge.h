// One directed edge of a polygon light as a receiver sees it: clipped at the receiver's horizon and projected
// onto the sphere. Each edge is independent of the others, so outlines may be concave, have holes and several
// loops. What closes an outline along the horizon is known from the points where its edges cross it.
//
// Seen from the light's front, the inside is on the left of every edge. Sums over edges are positive for such
// a receiver and negative for one that sees the back.
#ifndef PENUMBRA_POLYGON_EDGE_H
#define PENUMBRA_POLYGON_EDGE_H
#include "kernels/math/vec3_double.h"

PENUMBRA_NAMESPACE_BEGIN

/// The part of an edge above the horizon, an arc of a great circle.
STRUCT(VisibleEdge) {
  vec3d from, to;  ///< its end points, not normalised
  vec3d normal;    ///< unit, from x to; 0 if the edge's line passes through the receiver: then it has no arc
  double sine, cosine;  ///< of its angle, not normalised; sine >= 0
  double crossing;      ///< 1: it rises through the horizon at `from`; -1: it sets at `to`; 0: neither
};

/// The edge from a to b = a + d, both relative to the receiver; n is the receiver's normal.
FN VisibleEdge visible_edge(vec3d a, vec3d b, vec3d d, vec3d n) {
  const double za = dot3_d(n, a), zb = dot3_d(n, b);
  const bool above_a = za > 0.0, above_b = zb > 0.0;
  const bool crosses = above_a != above_b;
  const double t = crosses ? za / (za - zb) : 0.0;
  const vec3d meets = add_scaled_d(a, t, d);
  VisibleEdge e;
  e.from = select3_d(EITHER(above_a, !crosses), a, meets);
  e.to = select3_d(above_b, b, select3_d(crosses, meets, a));
  e.crossing = crosses ? (above_b ? 1.0 : -1.0) : 0.0;
  // Computed from the whole edge: clipping shortens the edge but keeps its great circle, d is exact, and a x
  // d keeps the digits that a x b loses for short edges.
  const vec3d g = cross3_d(a, d);
  const double length = SQRT_D(dot3_d(g, g));
  e.normal = scale_d(g, length > 0.0 ? 1.0 / length : 0.0);
  const double part = crosses ? (above_b ? 1.0 - t : t) : (above_b ? 1.0 : 0.0);
  e.sine = part * length;
  e.cosine = dot3_d(e.from, e.to);
  return e;
}

/// The sums over the edges of an outline. Twice the irradiance is the sum of the edges' angles, each times
/// the height of its great circle's normal (Lambert 1760), plus the angles along the horizon from where the
/// outline sets to where it rises. The latter are on one side of the horizon, where the light's plane cuts
/// it, and add up to less than half a turn. A product of unit complex numbers accumulates them, and one arc
/// tangent extracts their sum.
STRUCT(IrradianceSum) {
  double sum;
  double turn_x, turn_y;
};

FN IrradianceSum no_irradiance(void) {
  IrradianceSum s;
  s.sum = 0.0;
  s.turn_x = 1.0;
  s.turn_y = 0.0;
  return s;
}

/// Adds the point q where an edge crosses the horizon of a receiver with normal n; `crossing` as in
/// VisibleEdge.
FN IrradianceSum add_crossing(IrradianceSum s, double crossing, vec3d q, vec3d n) {
  // The horizon's frame is that of Duff et al. 2017.
  const double sign = n.z >= 0.0 ? 1.0 : -1.0;
  const double a = -1.0 / (sign + n.z), b = n.x * n.y * a;
  const double x = q.x * (1.0 + sign * n.x * n.x * a) + q.y * (sign * b) - q.z * (sign * n.x);
  const double y = q.x * b + q.y * (sign + n.y * n.y * a) - q.z * n.y;
  const double r2 = x * x + y * y;
  const bool turns = BOTH(crossing != 0.0, r2 > 0.0);
  const double scale = 1.0 / SQRT_D(turns ? r2 : 1.0);
  const double ux = turns ? x * scale : 1.0, uy = turns ? y * scale * crossing : 0.0;
  IrradianceSum r;
  r.sum = s.sum;
  r.turn_x = s.turn_x * ux - s.turn_y * uy;
  r.turn_y = s.turn_x * uy + s.turn_y * ux;
  return r;
}

FN vec3d crossing_place(VisibleEdge e) { return select3_d(e.crossing > 0.0, e.from, e.to); }

/// Adds an edge with its angle for a receiver with normal n.
FN IrradianceSum add_irradiance(IrradianceSum s, VisibleEdge e, double angle, vec3d n) {
  IrradianceSum r = add_crossing(s, e.crossing, crossing_place(e), n);
  r.sum = s.sum + angle * dot3_d(e.normal, n);
  return r;
}

/// The irradiance from a light of radiance 1: 0 to pi.
FN double total_irradiance(IrradianceSum s, bool two_sided) {
  // The outline is clockwise as seen by the receiver.
  const double signed_total = -0.5 * (s.sum + atan2_d(s.turn_y, s.turn_x));
  return clamp_d(two_sided ? FABS_D(signed_total) : signed_total, 0.0, PI_D);
}

FN IrradianceSum add_edge_irradiance(IrradianceSum s, vec3d a, vec3d b, vec3d d, vec3d n) {
  const VisibleEdge e = visible_edge(a, b, d, n);
  return add_irradiance(s, e, atan2_d(e.sine, e.cosine), n);
}

/// The irradiance at the origin with unit normal n from a triangle of radiance 1, in [0, pi]. a, b and c are
/// its corners; ab, bc and ca are the edges. It faces the side from which the corners are counter-clockwise.
FN double corners_irradiance(vec3d a, vec3d b, vec3d c, vec3d ab, vec3d bc, vec3d ca, vec3d n,
                             bool two_sided) {
  IrradianceSum s = no_irradiance();
  s = add_edge_irradiance(s, a, b, ab, n);
  s = add_edge_irradiance(s, b, c, bc, n);
  s = add_edge_irradiance(s, c, a, ca, n);
  return total_irradiance(s, two_sided);
}

/// The same at the point (px, py, pz) with unit normal (nx, ny, nz). The bits are those of polygon_terms.
FN double triangle_irradiance(double px, double py, double pz, double nx, double ny, double nz, vec3 p0,
                              vec3 p1, vec3 p2, bool two_sided) {
  const vec3d x = make_vec3d(px, py, pz), n = make_vec3d(nx, ny, nz);
  const vec3d q0 = widen3(p0), q1 = widen3(p1), q2 = widen3(p2);
  return corners_irradiance(sub_d(q0, x), sub_d(q1, x), sub_d(q2, x), sub_d(q1, q0), sub_d(q2, q1),
                            sub_d(q0, q2), n, two_sided);
}

PENUMBRA_NAMESPACE_END
#endif
