// Sampling of a triangle by the solid angle it subtends.
#ifndef PENUMBRA_SPHERICAL_TRIANGLE_H
#define PENUMBRA_SPHERICAL_TRIANGLE_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 v0, v1, v2;    ///< unit
  float determinant;  ///< |v0 . (v1 x v2)|
  float g0, g1;       ///< v0 . v2 + v1 . v2 and 1 + v0 . v1: two parts of the tangent's denominator
  float solid_angle;  ///< in [0, 4 pi)
} SphericalTriangle;

/// Vertices are relative to the shading point. Omega = 2 atan(V / (G0 + G1)) (Van Oosterom and Strackee
/// 1983).
FN SphericalTriangle spherical_triangle(vec3 a, vec3 b, vec3 c) {
  SphericalTriangle t;
  t.v0 = scale(a, 1.0f / SQRT(max_f(dot3(a, a), 1e-30f)));
  t.v1 = scale(b, 1.0f / SQRT(max_f(dot3(b, b), 1e-30f)));
  t.v2 = scale(c, 1.0f / SQRT(max_f(dot3(c, c), 1e-30f)));
  // Differences of vertices avoid cancellation in the determinant of a small triangle.
  t.determinant = FABS(dot3(t.v0, cross3(sub(t.v1, t.v0), sub(t.v2, t.v0))));
  // The sum of two almost opposite vertices is exact; 1 + v0 . v1 would lose all digits.
  const vec3 sum = add(t.v0, t.v1);
  const float cosine = dot3(t.v0, t.v1);
  const bool opposite = cosine < -0.5f;
  t.g0 = opposite ? dot3(sum, t.v2) : dot3(t.v0, t.v2) + dot3(t.v1, t.v2);
  t.g1 = opposite ? 0.5f * dot3(sum, sum) : 1.0f + cosine;
  t.solid_angle = 2.0f * atan2_f(t.determinant, t.g0 + t.g1);
  return t;
}

// If 1 + cos of an arc from v1 is below this, the arc's end does not determine its plane accurately.
#define NEARLY_OPPOSITE 0.02f

/// The tangent at v1 of the arc that cuts off an area E, given by sine and cosine of E / 2. It is unit, or 0
/// if the triangle has no such arc. With beta the angle between the tangent and the edge to v0, A the angle
/// at v0 and c the side from v0 to v1, the cosine rule for angles becomes sin(E/2) sin(A + beta - E/2) =
/// sin^2(c/2) sin A sin beta.
FN vec3 arc_tangent(SphericalTriangle t, float sine, float cosine) {
  const float sine_a = t.determinant,
              cosine_a = dot3(cross3(t.v0, t.v1), cross3(t.v0, t.v2));  // both times one factor
  const vec3 side = sub(t.v0, t.v1);
  const float sine_beta = sine * (sine_a * cosine - cosine_a * sine);
  const float cosine_beta = 0.25f * dot3(side, side) * sine_a - sine * (cosine_a * cosine + sine_a * sine);
  const vec3 along = sub(side, scale(t.v1, dot3(side, t.v1)));
  const vec3 across = cross3(t.v1, along);
  const float turn = dot3(t.v2, across) < 0.0f ? -sine_beta : sine_beta;
  const vec3 tangent = add(scale(along, cosine_beta), scale(across, turn));
  const float length2 = dot3(tangent, tangent);
  const bool exists = (length2 > 1e-30f) & (dot3(along, along) > 1e-12f);
  return scale(tangent, exists ? 1.0f / SQRT(exists ? length2 : 1.0f) : 0.0f);
}

/// Samples a unit direction uniformly in the triangle's solid angle. Peters 2021, BRDF Importance Sampling
/// for Polygonal Lights, section 2: cut off the fraction u by an arc through v1, then move along that arc by
/// v.
FN vec3 sample_spherical_triangle(SphericalTriangle t, float u, float v) {
  const float half_turns =
      t.solid_angle * u * (0.25f * INV_PI_F);  // half of the partial solid angle, over 2 pi
  float sine, cosine;
  sincos_2pi(half_turns, &sine, &cosine);
  const vec3 q = add(scale(t.v0, t.determinant * cosine - t.g0 * sine), scale(t.v2, t.g1 * sine));
  const float q2 = dot3(q, q);
  const vec3 end = sub(scale(q, 2.0f * dot3(t.v0, q) / max_f(q2, 1e-37f)), t.v0);
  // 1 - cos of the angles from v1 to the arc's end and to the sample, instead of the cosines: those of small
  // lights are near 1, where floats are sparse.
  const vec3 chord = sub(end, t.v1);
  const float versine2 = 0.5f * dot3(chord, chord);
  const float versine = v * versine2;
  const float denominator = versine2 * (2.0f - versine2);
  const float ratio = safe_sqrt(versine * (2.0f - versine) / (denominator > 0.0f ? denominator : 1.0f));
  const float along = denominator > 0.0f ? ratio : v;
  const vec3 by_chord = add(scale(t.v1, (1.0f - versine) + along * versine2), scale(chord, along));
  const vec3 tangent = arc_tangent(t, sine, cosine);
  const vec3 by_tangent =
      add(scale(t.v1, 1.0f - versine), scale(tangent, safe_sqrt(versine * (2.0f - versine))));
  const bool use_tangent = (versine2 > 2.0f - NEARLY_OPPOSITE) & (dot3(tangent, tangent) > 0.0f);
  return normalize3(select3(use_tangent, by_tangent, by_chord));
}

PENUMBRA_NAMESPACE_END
#endif
