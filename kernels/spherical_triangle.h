// Sampling a triangle by the solid angle it subtends.
#ifndef PENUMBRA_SPHERICAL_TRIANGLE_H
#define PENUMBRA_SPHERICAL_TRIANGLE_H
#include "kernels/math.h"
#include "kernels/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  vec3 v0, v1, v2;    ///< unit
  float determinant;  ///< |v0 . (v1 x v2)|
  float g0, g1;       ///< v0 . v2 + v1 . v2 and 1 + v0 . v1: the tangent's denominator in two parts
  float solid_angle;  ///< in [0, 4 pi)
} SphericalTriangle;

/// Vertices relative to the shading point. Omega = 2 atan(V / (G0 + G1)) (Van Oosterom and Strackee 1983).
FN SphericalTriangle spherical_triangle(vec3 a, vec3 b, vec3 c) {
  SphericalTriangle t;
  t.v0 = scale(a, 1.0f / SQRT(max_f(dot3(a, a), 1e-30f)));
  t.v1 = scale(b, 1.0f / SQRT(max_f(dot3(b, b), 1e-30f)));
  t.v2 = scale(c, 1.0f / SQRT(max_f(dot3(c, c), 1e-30f)));
  // Edges instead of vertices: the determinant of a small triangle is a small difference otherwise.
  t.determinant = FABS(dot3(t.v0, cross3(sub(t.v1, t.v0), sub(t.v2, t.v0))));
  // The sum of two almost opposite vertices is exact, where 1 + v0 . v1 would lose all digits.
  const vec3 sum = add(t.v0, t.v1);
  const float cosine = dot3(t.v0, t.v1);
  const bool opposite = cosine < -0.5f;
  t.g0 = opposite ? dot3(sum, t.v2) : dot3(t.v0, t.v2) + dot3(t.v1, t.v2);
  t.g1 = opposite ? 0.5f * dot3(sum, sum) : 1.0f + cosine;
  t.solid_angle = 2.0f * atan2_f(t.determinant, t.g0 + t.g1);
  return t;
}

/// A unit direction uniform over the triangle's solid angle. Peters 2021, BRDF Importance Sampling for
/// Polygonal Lights, section 2: cut off the fraction u by an arc through v1, then move along it by v.
FN vec3 sample_spherical_triangle(SphericalTriangle t, float u, float v) {
  const float half_turns = t.solid_angle * u * (0.25f * INV_PI_F);  // half the partial solid angle over 2 pi
  float sine, cosine;
  sincos_2pi(half_turns, &sine, &cosine);
  const vec3 q = add(scale(t.v0, t.determinant * cosine - t.g0 * sine), scale(t.v2, t.g1 * sine));
  const float q2 = dot3(q, q);
  const vec3 end = sub(scale(q, 2.0f * dot3(t.v0, q) / max_f(q2, 1e-37f)), t.v0);
  // 1 - cos of the angles from v1 to the arc's end and to the sample, not the cosines: those of small lights
  // are near 1, where few numbers are.
  const vec3 chord = sub(end, t.v1);
  const float versine2 = 0.5f * dot3(chord, chord);
  const float versine = v * versine2;
  const float denominator = versine2 * (2.0f - versine2);
  const float ratio = safe_sqrt(versine * (2.0f - versine) / (denominator > 0.0f ? denominator : 1.0f));
  const float along = denominator > 0.0f ? ratio : v;
  return normalize3(add(scale(t.v1, (1.0f - versine) + along * versine2), scale(chord, along)));
}

PENUMBRA_NAMESPACE_END
#endif
