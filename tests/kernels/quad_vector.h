// Numbers and vectors of 113 bits: the reference for closed forms in double.
#pragma once

#include "scheduler/stress/truth/quad.h"
#include "tests/kernels/exact_vector.h"

namespace penumbra {

using stress::abs_q, stress::atan2_q, stress::cos_q, stress::exp_q, stress::expm1_q, stress::log1p_q,
    stress::log_q, stress::sin_q, stress::sqrt_q;
using stress::kQuadPi, stress::Quad, stress::Quad3;

inline Quad3 quad(const vec3& v) { return {v.x, v.y, v.z}; }
inline Quad3 quad(const Exact3& v) { return {v.x, v.y, v.z}; }
inline Exact3 exact(const Quad3& a) { return {(long double)a.x, (long double)a.y, (long double)a.z}; }

}  // namespace penumbra
