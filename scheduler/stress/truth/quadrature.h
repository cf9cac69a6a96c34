// Numerical integration in 113 bits.
#pragma once

#include <functional>

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

/// Integral of f over [a, b] by the tanh-sinh rule (Takahasi and Mori 1974), which stands singular
/// derivatives at the ends.
Quad tanh_sinh(const std::function<Quad(Quad)>& f, Quad a, Quad b);

/// The same over consecutive intervals, `bounds` in any order: put one wherever f has a kink or a peak.
Quad tanh_sinh(const std::function<Quad(Quad)>& f, std::vector<Quad> bounds);

}  // namespace penumbra::stress
