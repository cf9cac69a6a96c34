// Conversion between GLM's vectors, which host code uses, and the kernels' vectors.
#pragma once

#include <glm/vec3.hpp>

#include "kernels/math/vec3.h"

namespace penumbra {

inline vec3 to_vec3(const glm::vec3& v) { return make_vec3(v.x, v.y, v.z); }
/// Rounds to single precision.
inline vec3 to_vec3(const glm::dvec3& v) { return make_vec3(float(v.x), float(v.y), float(v.z)); }
inline glm::dvec3 to_dvec3(const vec3& v) { return {double(v.x), double(v.y), double(v.z)}; }

}  // namespace penumbra
