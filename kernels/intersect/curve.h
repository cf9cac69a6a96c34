// Pieces of curves. A piece is straight, from `p0` to `p1`, with a radius and the curve's unit tangent at
// both ends. It is cut by the planes across these tangents, which neighbours share, so that a curve has
// neither gaps nor joints. A round piece is a cone, of which only the outside is hit: light that has entered
// a fibre has left it already, as in Embree. With balls, the piece is all spheres between those at its ends.
// A flat piece is a ribbon that faces each ray, as in pbrt: the points of the plane across the ray that are
// within a radius of the curve.
#ifndef PENUMBRA_CURVE_H
#define PENUMBRA_CURVE_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"
#include "kernels/scene_types.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 p0, p1, t0, t1;
  float r0, r1;
  float begin, span;  ///< the curve's parameter at p0, and by how much it grows to p1
  int kind;
} CurvePiece;

/// False only if the line through `o` along the unit direction `d` passes the piece: it is further from its
/// middle than the ends are and 2.3 radii, which bounds_of_curve explains. (a + b)^2 is at most 2 a^2 + 2
/// b^2, and the rounding of the distance is below 1e-6 of that to the middle.
FN bool may_meet_curve(Quadric q, vec3 o, vec3 d) {
  const vec3 middle = sub(scale(add(q.center, q.x_axis), 0.5f), o), step = sub(q.x_axis, q.center);
  const vec3 aside = add_scaled(middle, -dot3(middle, d), d);
  const float most = 0.5f * dot3(step, step) + 10.6f * sqr(max_f(q.radius, q.length));
  return dot3(aside, aside) <= 1.0001f * most + 1e-8f * dot3(middle, middle);
}

/// The piece that a quadric's record holds.
FN CurvePiece curve_piece(Quadric q) {
  CurvePiece c;
  c.p0 = q.center;
  c.p1 = q.x_axis;
  c.t0 = q.normal;
  c.span = length3(q.y_axis);
  c.t1 = scale(q.y_axis, 1.0f / c.span);
  c.r0 = q.radius;
  c.r1 = q.length;
  c.begin = q.orientation;
  c.kind = q.kind;
  return c;
}

/// The axis of a round piece: its direction, its length, and the sine of the cone's slope, by which normals
/// lean towards p1.
typedef struct {
  vec3 along;
  float length, lean;
} CurveAxis;

FN CurveAxis curve_axis(CurvePiece c) {
  const vec3 step = sub(c.p1, c.p0);
  CurveAxis a;
  a.length = length3(step);
  const float inverse = 1.0f / max_f(a.length, 1e-30f);
  a.along = scale(step, inverse);
  a.lean = (c.r0 - c.r1) * inverse;
  return a;
}

/// How far along the axis the centre of the sphere is that touches the cone at `height`.
FN float sphere_height(CurvePiece c, CurveAxis a, float height) {
  return (height - c.r0 * a.lean) / (1.0f - a.lean * a.lean);
}

/// Distance to where the ray enters the sphere at p0 + height along, or a negative number.
FN float enter_curve_ball(vec3 from, vec3 d, float radius) {
  const float b = -dot3(from, d);
  const vec3 closest = add_scaled(from, b, d);
  const float discriminant = sqr(radius) - dot3(closest, closest);
  return discriminant >= 0.0f ? b - SQRT(discriminant) : -1.0f;
}

/// Where a ray enters a round piece with balls through one of them, or a negative number.
FN float intersect_balls(CurvePiece c, CurveAxis a, vec3 o, vec3 d) {
  const float first = enter_curve_ball(sub(o, c.p0), d, c.r0),
              second = enter_curve_ball(sub(o, c.p1), d, c.r1);
  // One may contain the other.
  if (a.lean >= 1.0f) return first;
  if (a.lean <= -1.0f) return second;
  const float first_height = dot3(add_scaled(sub(o, c.p0), first, d), a.along);
  const float second_height = dot3(add_scaled(sub(o, c.p0), second, d), a.along);
  if ((first > 0.0f) & (sphere_height(c, a, first_height) <= 0.0f)) return first;
  if ((second > 0.0f) & (sphere_height(c, a, second_height) >= a.length)) return second;
  return -1.0f;
}

/// Distance along the unit direction `d` to where the ray enters the piece, or a negative number. The cone is
/// where cos^2 rho^2 = (r0 - sin z)^2, at a distance rho from the axis and z along it; the ray's point next
/// to the axis keeps the discriminant accurate for distant and thin pieces.
FN float intersect_round(CurvePiece c, vec3 o, vec3 d) {
  const CurveAxis a = curve_axis(c);
  const bool balls = c.kind == QUADRIC_ROUND_BALLS;
  const float cosine2 = (1.0f - a.lean) * (1.0f + a.lean);
  if (cosine2 > 0.0f) {
    const vec3 from = sub(o, c.p0);
    const float climb = dot3(d, a.along);
    const vec3 across = add_scaled(d, -climb, a.along);
    const float speed2 = dot3(across, across);
    const vec3 aside = add_scaled(from, -dot3(from, a.along), a.along);
    const float near = speed2 > 1e-12f ? -dot3(aside, across) / speed2 : 0.0f;
    const vec3 start = add_scaled(from, near, d);
    const float height = dot3(start, a.along);
    const vec3 closest = add_scaled(start, -height, a.along);
    const float radius = c.r0 - a.lean * height;
    const float k2 = cosine2 * speed2 - sqr(a.lean * climb);
    const float k1 = cosine2 * dot3(closest, across) + a.lean * climb * radius;
    const float k0 = cosine2 * dot3(closest, closest) - sqr(radius);
    const float discriminant = k1 * k1 - k2 * k0;
    if (discriminant >= 0.0f) {
      const float root = SQRT(discriminant);
      const float off = k1 >= 0.0f ? -(k1 + root) / k2 : k0 / (root - k1);
      const float z = height + off * climb;
      const vec3 x = add_scaled(start, off, d);
      const float center = sphere_height(c, a, z), most = max_f(c.r0, c.r1);
      const float after = dot3(x, c.t0), before = dot3(sub(x, sub(c.p1, c.p0)), c.t1);
      const bool within = balls ? (center >= 0.0f) & (center <= a.length)
                                : (after >= 0.0f) & (before <= 0.0f) & (z >= -most) & (z <= a.length + most);
      if (within & (c.r0 - a.lean * z > 0.0f)) return near + off;
    }
  }
  return balls ? intersect_balls(c, a, o, d) : -1.0f;
}

/// Where the ray passes nearest to the piece, in the plane across the ray.
typedef struct {
  float s;      ///< share of the way from p0 to p1
  float t;      ///< distance of the piece along the ray
  vec3 aside;   ///< from the ray to the piece
  bool within;  ///< of the width and between the cuts
} RibbonPoint;

FN RibbonPoint meet_ribbon(CurvePiece c, vec3 o, vec3 d) {
  const vec3 a = sub(c.p0, o), b = sub(c.p1, o);
  const float at = dot3(a, d), bt = dot3(b, d);
  const vec3 from = add_scaled(a, -at, d), to = add_scaled(b, -bt, d), step = sub(to, from);
  const float length2 = dot3(step, step);
  RibbonPoint r;
  r.s = length2 > 0.0f ? clamp_f(-dot3(from, step) / length2, 0.0f, 1.0f) : 0.5f;
  r.t = mix_f(at, bt, r.s);
  r.aside = add_scaled(from, r.s, step);
  const float radius = mix_f(c.r0, c.r1, r.s);
  const float distance2 = dot3(r.aside, r.aside), radius2 = sqr(radius);
  const float before = dot3(from, c.t0), after = dot3(to, c.t1);
  r.within = (distance2 < radius2) & (before <= 0.0f) & (after >= 0.0f);
  return r;
}

/// Distance along the unit direction `d` to the piece, or a negative number.
FN float intersect_curve(CurvePiece c, vec3 o, vec3 d) {
  if ((c.kind == QUADRIC_ROUND) | (c.kind == QUADRIC_ROUND_BALLS)) return intersect_round(c, o, d);
  const RibbonPoint r = meet_ribbon(c, o, d);
  return r.within ? r.t : -1.0f;
}

PENUMBRA_NAMESPACE_END
#endif
