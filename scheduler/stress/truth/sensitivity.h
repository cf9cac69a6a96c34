// Condition numbers by experiment: how far a result moves when its inputs are rounded.
#pragma once

#include <functional>

#include "scheduler/stress/truth/quad.h"

namespace penumbra::stress {

using QuadFunction = std::function<std::vector<Quad>(const std::vector<Quad>& inputs)>;

inline constexpr double kUlp = 1.0 / (1 << 24);  ///< 2^-24: relative rounding error of one operation in float

/// The sum over all inputs of how far f moves when that input alone moves by its delta either way: a bound,
/// to first order, for inputs off by up to their deltas together. It is what the inputs' rounding costs any
/// algorithm. Where f has no value the move does not count.
double sensitivity(const QuadFunction& f, const std::vector<Quad>& inputs, const std::vector<double>& deltas);

/// For inputs that are vectors of three, one after the other, then numbers of [0, 1]: `relative` times the
/// length of a vector for each of its components, times 1 for the numbers.
std::vector<double> rounding(const std::vector<Quad>& inputs, std::size_t vectors, double relative);

}  // namespace penumbra::stress
