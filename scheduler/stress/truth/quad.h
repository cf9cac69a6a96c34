// Numbers and vectors with 113 bits of precision, in which the truth of a case is computed.
#pragma once

#include <vector>

namespace penumbra::stress {

/// IEEE binary128.
using Quad = __float128;

// The C library has these elementary functions, but not every compiler's headers declare them.
Quad sqrt_q(Quad x) __asm__("sqrtf128");
Quad sin_q(Quad x) __asm__("sinf128");
Quad cos_q(Quad x) __asm__("cosf128");
Quad asin_q(Quad x) __asm__("asinf128");
Quad atan2_q(Quad y, Quad x) __asm__("atan2f128");
Quad exp_q(Quad x) __asm__("expf128");
Quad expm1_q(Quad x) __asm__("expm1f128");
Quad log_q(Quad x) __asm__("logf128");
Quad log1p_q(Quad x) __asm__("log1pf128");
Quad lgamma_q(Quad x) __asm__("lgammaf128");

inline constexpr Quad kQuadPi =
    2 * Quad(1.5707963267948966) + 2 * Quad(6.123233995736766e-17) + 2 * Quad(-1.4973849048591833e-33);

inline Quad abs_q(Quad x) { return x < 0 ? -x : x; }
inline Quad max_q(Quad a, Quad b) { return a > b ? a : b; }
inline Quad min_q(Quad a, Quad b) { return a < b ? a : b; }

struct Quad3 {
  Quad x = 0, y = 0, z = 0;
};

inline Quad3 operator+(const Quad3& a, const Quad3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Quad3 operator-(const Quad3& a, const Quad3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Quad3 operator-(const Quad3& a) { return {-a.x, -a.y, -a.z}; }
inline Quad3 operator*(Quad s, const Quad3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Quad dot(const Quad3& a, const Quad3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Quad3 cross(const Quad3& a, const Quad3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Quad length(const Quad3& a) { return sqrt_q(dot(a, a)); }
inline Quad3 normalize(const Quad3& a) { return (1 / length(a)) * a; }
inline Quad angle_between(const Quad3& a, const Quad3& b) { return atan2_q(length(cross(a, b)), dot(a, b)); }

}  // namespace penumbra::stress
