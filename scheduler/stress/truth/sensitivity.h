// Numerical condition numbers: how much a result changes when its inputs are rounded.
#pragma once

#include <functional>

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

using QuadFunction = std::function<std::vector<Quad>(const std::vector<Quad>& inputs)>;

/// 2^-24: the relative rounding error of one operation in float.
inline constexpr double kUlp = 1.0 / (1 << 24);

/// The sum over all inputs of the change of f when that input alone changes by its delta in either direction.
/// It bounds, to first order, the error for inputs that are all off by up to their deltas, which is
/// inevitable for any algorithm. Changes to where f is undefined are ignored.
double sensitivity(const QuadFunction& f, const std::vector<Quad>& inputs, const std::vector<double>& deltas);

/// Deltas for inputs that are vectors of three components, one after the other, followed by numbers in [0,
/// 1]. They are `relative` times the vector's length for each component, and `relative` for the numbers.
std::vector<double> rounding(const std::vector<Quad>& inputs, std::size_t vectors, double relative);

}  // namespace penumbra::stress
