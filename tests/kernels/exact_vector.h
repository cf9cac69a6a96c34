// Vectors in extended precision: the reference for single-precision kernels.
#pragma once

#include <cmath>

#include "kernels/math/vec3.h"

namespace penumbra {

struct Exact3 {
  long double x = 0, y = 0, z = 0;
};

inline Exact3 exact(const vec3& v) { return {v.x, v.y, v.z}; }
inline Exact3 operator+(const Exact3& a, const Exact3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Exact3 operator-(const Exact3& a, const Exact3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Exact3 operator*(long double s, const Exact3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline long double dot(const Exact3& a, const Exact3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Exact3 cross(const Exact3& a, const Exact3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline long double length(const Exact3& a) { return std::sqrt(dot(a, a)); }
inline Exact3 normalize(const Exact3& a) { return (1 / length(a)) * a; }
inline vec3 rounded(const Exact3& a) { return make_vec3(float(a.x), float(a.y), float(a.z)); }

}  // namespace penumbra
