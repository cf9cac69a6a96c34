// Equality of the values in records.
#pragma once

#include "kernels/math/vec3.h"

namespace penumbra {

inline bool same(int a, int b) { return a == b; }
inline bool same(float a, float b) { return a == b; }
inline bool same(bool a, bool b) { return a == b; }
inline bool same(const vec3& a, const vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

}  // namespace penumbra
