// Sampling of a planar rectangle by the solid angle it subtends, after Urena, Fajardo and King 2013, An
// Area-Preserving Parametrization for Spherical Rectangles, in formulas that are stable in single precision.
//
// The frame has x and y along the sides and z towards the plane. Let f(x) be the solid angle of the part
// between the sides y0 and y1 and between the abscissae 0 and x; it grows from -D at minus infinity to D.
// With tan(a_i) = y_i / z and sin(s) = x / sqrt(x^2 + z^2), f(x) = asin(sin(a1) sin(s)) - asin(sin(a0)
// sin(s)) and D = a1 - a0. Solved for x,
//   x / z = sin(f) / sqrt(q (q + 2 cos(a0) cos(a1))),
//   q = cos(f) - cos(D) = 2 sin((D + f) / 2) sin((D - f) / 2).
// Along the line at x, the sine of the latitude, y / sqrt(x^2 + y^2 + z^2), is uniform (Archimedes).
#ifndef PENUMBRA_SPHERICAL_RECTANGLE_H
#define PENUMBRA_SPHERICAL_RECTANGLE_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

// Below this solid angle, area sampling is as good: random numbers are added to angles of up to pi, whose
// rounding error is a ten-thousandth of it.
#define SMALL_RECTANGLE_SOLID_ANGLE 1e-3f

typedef struct {
  vec3 x, y, z;          ///< unit: along the sides, and from the shading point to the plane
  float x0, x1, y0, y1;  ///< the sides in that frame; the unit is about the distance plus the extent
  float width, height;   ///< x1 - x0 and y1 - y0
  float distance;        ///< of the plane, > 0
  float first, strip;    ///< f(x0) and D
  float solid_angle;     ///< in [0, 2 pi]
} SphericalRectangle;

/// y1 r0 - y0 r1 for r_i = sqrt(c + y_i^2) and height = y1 - y0, without cancellation.
FN float rectangle_rise(float c, float y0, float y1, float height, float r0, float r1) {
  const float product = y0 * y1, r = r0 * r1;
  const float near = product > 0.0f ? c * (c + (y0 * y0 + y1 * y1)) / (r + product) : r - product;
  return height * (c + near) / (r0 + r1);
}

/// f(x), where r0 and r1 are the distances of (x, y0) and (x, y1).
FN float rectangle_part(float x, float y0, float y1, float height, float z, float r0, float r1) {
  const float x2 = x * x, z2 = z * z;
  const float rise = rectangle_rise(x2 + z2, y0, y1, height, r0, r1);
  return atan2_f(x * z * rise, z2 * (r0 * r1) + x2 * (y0 * y1));
}

/// `corner` and the corners next and previous to it, relative to the shading point, which may be on either
/// side. The edges must be perpendicular except for rounding. The solid angle is, with a relative error of
/// 1e-6, that of a rectangle whose corners are moved by up to 2^-23 of the distance to the farthest one along
/// each axis.
FN SphericalRectangle spherical_rectangle(vec3 corner, vec3 next, vec3 previous) {
  SphericalRectangle s;
  const vec3 e0 = sub(next, corner), e1 = sub(previous, corner);
  const float length0 = length3(e0), length1 = length3(e1);
  const float unit = 1.0f / max_f(length3(corner) + (length0 + length1), 1e-30f);
  // Rounding rotates the shorter edge more, so the shorter one is made perpendicular to the longer one.
  const bool first_longer = length0 > length1;
  const vec3 longer = select3(first_longer, scale(e0, 1.0f / max_f(length0, 1e-30f)),
                              scale(e1, 1.0f / max_f(length1, 1e-30f)));
  const vec3 shorter = select3(first_longer, e1, e0);
  const vec3 across = add_scaled(shorter, -dot3(shorter, longer), longer);
  const vec3 other = scale(across, 1.0f / max_f(length3(across), 1e-30f));
  s.x = select3(first_longer, longer, other);
  s.y = select3(first_longer, other, longer);
  const vec3 normal = cross3(s.x, s.y);
  const float side = dot3(corner, normal);
  s.z = scale(normal, sign_of(side));
  s.distance = max_f(FABS(side) * unit, 1e-18f);
  s.width = length0 * unit;
  s.height = length1 * unit;
  s.x0 = dot3(corner, s.x) * unit;
  s.y0 = dot3(corner, s.y) * unit;
  s.x1 = s.x0 + s.width;
  s.y1 = s.y0 + s.height;
  const float z2 = sqr(s.distance);
  const float x00 = sqr(s.x0), x11 = sqr(s.x1), y00 = sqr(s.y0), y11 = sqr(s.y1);
  const float r0 = SQRT((x00 + z2) + y00), r1 = SQRT((x11 + z2) + y00), r2 = SQRT((x11 + z2) + y11),
              r3 = SQRT((x00 + z2) + y11);
  s.first = rectangle_part(s.x0, s.y0, s.y1, s.height, s.distance, r0, r3);
  const float last = rectangle_part(s.x1, s.y0, s.y1, s.height, s.distance, r1, r2);
  s.strip = atan2_f(s.height * s.distance, z2 + s.y0 * s.y1);
  // The difference of parts is accurate if the rectangle is large or close to its plane. Otherwise the sum of
  // its two triangles is used (Van Oosterom and Strackee 1983), whose determinants are the same product.
  const float x01 = s.x0 * s.x1, y01 = s.y0 * s.y1;
  const float diagonal = x01 + y01 + z2;
  const float determinant = s.distance * s.width * s.height;
  const float cube_a = r0 * r1 * r2, cube_b = r0 * r2 * r3;
  const float a = cube_a + (x01 + y00 + z2) * r2 + (x11 + y01 + z2) * r0 + diagonal * r1;
  const float b = cube_b + (x00 + y01 + z2) * r2 + (x01 + y11 + z2) * r0 + diagonal * r3;
  const float triangles = 2.0f * atan2_f(determinant * (a + b), a * b - determinant * determinant);
  s.solid_angle = ((a > cube_a) & (b > cube_b)) ? triangles : max_f(last - s.first, 0.0f);
  return s;
}

/// Samples a unit direction uniformly in the rectangle's solid angle: u runs along the side from the corner
/// to the next one, v along the other. The direction points into the rectangle of moved corners (see above),
/// or misses it by up to 2^-21.
FN vec3 sample_spherical_rectangle(SphericalRectangle s, float u, float v) {
  const float part = s.first + u * s.solid_angle;
  const float z2 = sqr(s.distance);
  float sine_a, cosine_a, sine_b, cosine_b;
  sincos_2pi(max_f(s.strip + part, 0.0f) * (0.25f * INV_PI_F), &sine_a, &cosine_a);
  sincos_2pi(max_f(s.strip - part, 0.0f) * (0.25f * INV_PI_F), &sine_b, &cosine_b);
  const float half_q = sine_a * sine_b;
  const float cosines = z2 / SQRT((sqr(s.y0) + z2) * (sqr(s.y1) + z2));
  const float tangent =
      (sine_a * cosine_b - cosine_a * sine_b) / (2.0f * SQRT(max_f(half_q * (half_q + cosines), 1e-37f)));
  const float x = clamp_f(s.distance * tangent, s.x0, s.x1);
  const float c = x * x + z2;
  const float r0 = SQRT(c + sqr(s.y0)), r1 = SQRT(c + sqr(s.y1));
  // 1 + h and 1 - h for the sine h of the latitude, both as sums of positive terms.
  const float range = rectangle_rise(c, s.y0, s.y1, s.height, r0, r1) / (r0 * r1);
  const float above = (s.y0 < 0.0f ? c / (r0 * (r0 - s.y0)) : 1.0f + s.y0 / r0) + v * range;
  const float below = (s.y1 > 0.0f ? c / (r1 * (r1 + s.y1)) : 1.0f - s.y1 / r1) + (1.0f - v) * range;
  const float y = clamp_f(0.5f * (above - below) * SQRT(c / (above * below)), s.y0, s.y1);
  return normalize3(add(add(scale(s.x, x), scale(s.y, y)), scale(s.z, s.distance)));
}

PENUMBRA_NAMESPACE_END
#endif
