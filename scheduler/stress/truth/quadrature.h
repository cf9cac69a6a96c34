// Numerical integration in 113-bit arithmetic.
#pragma once

#include <functional>

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

/// The integral of f over [a, b] by the tanh-sinh rule (Takahasi and Mori 1974), which tolerates
/// singularities of derivatives at the ends.
Quad tanh_sinh(const std::function<Quad(Quad)>& f, Quad a, Quad b);

/// The same over consecutive intervals between `bounds`, given in any order. Put a bound at every kink or
/// peak of f.
Quad tanh_sinh(const std::function<Quad(Quad)>& f, std::vector<Quad> bounds);

}  // namespace penumbra::stress
