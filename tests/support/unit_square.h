// Quadrature over the unit square.
#pragma once

namespace penumbra {

/// Integral of value(x, y) by the midpoints of a grid of nodes^2 squares: where `value` is smooth, the error
/// is of second order.
template <typename Value>
double unit_square_integral(int nodes, const Value& value) {
  double sum = 0;
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j) sum += value((i + 0.5) / nodes, (j + 0.5) / nodes);
  return sum / (double(nodes) * nodes);
}

}  // namespace penumbra
