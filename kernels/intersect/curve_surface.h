// The surfaces of curves.
#ifndef PENUMBRA_CURVE_SURFACE_H
#define PENUMBRA_CURVE_SURFACE_H
#include "kernels/intersect/curve.h"
#include "kernels/intersect/surface_uv.h"

PENUMBRA_NAMESPACE_BEGIN

// Rounding error of b0 p0 + b1 p1 + b2 p2 with rounded barycentrics, gamma(7), doubled to cover the rounding
// of the offset origin itself (Pharr, Jakob and Humphreys 2016, section 3.9).
#define POSITION_ERROR (16.0f * HALF_EPSILON)
// Rays leave a ribbon from so many radii before or behind it, since it turns to face them (pbrt: from two
// widths), and a round curve from so many, since it bends.
#define LEAVE_RIBBON 2.5f
#define LEAVE_ROUND 2e-3f

/// Two unit vectors across a curve's tangent: where Mitsuba's u is 0, and a quarter turn further.
typedef struct {
  vec3 first, second;
} AcrossCurve;
FN AcrossCurve across_curve(vec3 tangent) {
  const float length = SQRT(sqr(tangent.x) + sqr(tangent.y));
  const bool some = length > 1e-6f;
  const float inverse = some ? 1.0f / length : 0.0f;
  AcrossCurve a;
  a.first = make_vec3(some ? -tangent.y * inverse : (tangent.z < 0.0f ? -1.0f : 1.0f),
                      some ? tangent.x * inverse : 0.0f, 0.0f);
  a.second = cross3(tangent, a.first);
  return a;
}

FN vec3 curve_tangent(CurvePiece c, float s) { return normalize3(mix3(c.t0, c.t1, s)); }

/// An extent by which seen_surface finds at least the error `error` along the unit normal n.
FN vec3 extent_of_error(vec3 n, float error) { return scale(abs3(n), error / POSITION_ERROR); }

/// Where the ray from `o` along the unit direction `d` meets the round piece. Its normal is that of the
/// curve, as long as it faces the ray; b0 and b1 are the texture coordinates, around and along the curve.
FN PrimitivePoint point_on_round(CurvePiece c, vec3 o, vec3 d) {
  const CurveAxis a = curve_axis(c);
  PrimitivePoint r;
  r.distance = intersect_round(c, o, d);
  const vec3 x = add_scaled(sub(o, c.p0), r.distance, d);
  const bool balls = c.kind == QUADRIC_ROUND_BALLS;
  const float center = sphere_height(c, a, dot3(x, a.along));
  const float within = clamp_f(center, 0.0f, a.length);
  const float height = balls ? (a.lean >= 1.0f ? 0.0f : a.lean <= -1.0f ? a.length : within) : center;
  const vec3 out = normalize3(add_scaled(x, -height, a.along));
  const float radius = c.r0 - a.lean * height;
  r.p = add(c.p0, add_scaled(scale(a.along, height), radius, out));
  const float s = clamp_f(dot3(sub(r.p, c.p0), a.along) / max_f(a.length, 1e-30f), 0.0f, 1.0f);
  const vec3 tangent = curve_tangent(c, s);
  const vec3 side = normalize3(add_scaled(out, -dot3(out, tangent), tangent));
  const vec3 smooth = add_scaled(scale(side, safe_sqrt(1.0f - a.lean * a.lean)), a.lean, tangent);
  const bool faces = (dot3(smooth, d) < 0.0f) & !balls;
  r.normal = r.shading = select3(faces, smooth, out);
  const AcrossCurve axes = across_curve(tangent);
  r.b0 = turns_of(dot3(side, axes.first), dot3(side, axes.second));
  r.b1 = c.begin + s * c.span;
  const float size = a.length + max_f(c.r0, c.r1);
  r.extent =
      add(add(abs3(c.p0), make_vec3(size, size, size)), extent_of_error(r.normal, LEAVE_ROUND * radius));
  return r;
}

/// Where it meets the ribbon; b0 is along it, b1 across it, in the direction of the cross product of the
/// normal that faces the ray and the tangent.
FN PrimitivePoint point_on_ribbon(CurvePiece c, vec3 o, vec3 d) {
  const RibbonPoint at = meet_ribbon(c, o, d);
  PrimitivePoint r;
  r.distance = at.t;
  r.p = add_scaled(o, at.t, d);
  const vec3 tangent = curve_tangent(c, at.s);
  vec3 facing = add_scaled(negate(d), dot3(d, tangent), tangent);
  const float length2 = dot3(facing, facing);
  facing = select3(length2 > 1e-12f, scale(facing, 1.0f / SQRT(max_f(length2, 1e-30f))), negate(d));
  const vec3 across = cross3(facing, tangent);
  const float radius = mix_f(c.r0, c.r1, at.s);
  const float offset = SQRT(dot3(at.aside, at.aside)) / max_f(radius, 1e-30f);
  const float side = dot3(at.aside, across) > 0.0f ? -1.0f : 1.0f;
  const float h = side * min_f(offset, 1.0f);
  // pbrt turns the normals of a cylinder evenly from edge to edge.
  float sine, cosine;
  sincos_2pi(0.25f * h, &sine, &cosine);
  const vec3 turned = add_scaled(scale(facing, cosine), sine, across);
  r.normal = r.shading = select3(c.kind == QUADRIC_CYLINDRICAL_RIBBON, turned, facing);
  r.b0 = c.begin + at.s * c.span;
  r.b1 = 0.5f + 0.5f * h;
  r.extent = add(add(abs3(c.p0), abs3(sub(r.p, c.p0))), extent_of_error(r.normal, LEAVE_RIBBON * radius));
  return r;
}

FN PrimitivePoint point_on_curve(Quadric q, vec3 o, vec3 d) {
  const CurvePiece c = curve_piece(q);
  const bool round = (c.kind == QUADRIC_ROUND) | (c.kind == QUADRIC_ROUND_BALLS);
  PrimitivePoint r = round ? point_on_round(c, o, d) : point_on_ribbon(c, o, d);
  r.b2 = 0.0f;
  r.front = q.front;
  r.back = q.back;
  r.light = q.light;
  return r;
}

/// The texture coordinates of point_on_curve, and the direction in which u grows.
FN QuadricUv curve_uv(Quadric q, PrimitivePoint r) {
  const CurvePiece c = curve_piece(q);
  const bool round = (c.kind == QUADRIC_ROUND) | (c.kind == QUADRIC_ROUND_BALLS);
  const float along = round ? r.b1 : r.b0;
  const vec3 tangent = curve_tangent(c, clamp_f((along - c.begin) / c.span, 0.0f, 1.0f));
  const AcrossCurve axes = across_curve(tangent);
  float s, cosine;
  sincos_2pi(r.b0 - floor_f(r.b0), &s, &cosine);
  QuadricUv uv;
  uv.at.u = r.b0;
  uv.at.v = r.b1;
  uv.du = select3(round, sub(scale(axes.second, cosine), scale(axes.first, s)), tangent);
  return uv;
}

/// How the position changes with the texture coordinates u and v of a curve's point, without the turn of its
/// frame. `front`: the unit normal there.
FN void curve_derivatives(Quadric q, float u, float v, vec3 front, PRIVATE vec3* du, PRIVATE vec3* dv) {
  const CurvePiece c = curve_piece(q);
  const bool round = (c.kind == QUADRIC_ROUND) | (c.kind == QUADRIC_ROUND_BALLS);
  const float s = clamp_f(((round ? v : u) - c.begin) / c.span, 0.0f, 1.0f);
  const vec3 along = scale(sub(c.p1, c.p0), 1.0f / c.span);
  const vec3 across = normalize3(cross3(front, along));
  const float radius = mix_f(c.r0, c.r1, s);
  *du = round ? scale(across, -2.0f * PI_F * radius) : along;
  *dv = round ? add_scaled(along, (c.r1 - c.r0) / c.span, front) : scale(across, 2.0f * radius);
}

PENUMBRA_NAMESPACE_END
#endif
