#include "scheduler/stress/truth/sensitivity.h"

#include <algorithm>
#include <cmath>

namespace penumbra::stress {

double sensitivity(const QuadFunction& f, const std::vector<Quad>& inputs,
                   const std::vector<double>& deltas) {
  const std::vector<Quad> here = f(inputs);
  double total = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (deltas[i] == 0) continue;
    double most = 0;
    for (const int sign : {-1, 1}) {
      std::vector<Quad> moved = inputs;
      moved[i] += sign * Quad(deltas[i]);
      const std::vector<Quad> there = f(moved);
      Quad squares = 0;
      for (std::size_t k = 0; k < here.size(); ++k) squares += (there[k] - here[k]) * (there[k] - here[k]);
      const double distance = double(sqrt_q(squares));
      if (std::isfinite(distance)) most = std::max(most, distance);
    }
    total += most;
  }
  return total;
}

std::vector<double> rounding(const std::vector<Quad>& inputs, std::size_t vectors, double relative) {
  std::vector<double> deltas(inputs.size(), relative);
  for (std::size_t i = 0; i < vectors; ++i) {
    const double size = double(length({inputs[3 * i], inputs[3 * i + 1], inputs[3 * i + 2]}));
    for (std::size_t k = 0; k < 3; ++k) deltas[3 * i + k] = relative * size;
  }
  return deltas;
}

}  // namespace penumbra::stress
