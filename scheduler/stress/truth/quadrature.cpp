#include "scheduler/stress/truth/quadrature.h"

#include <algorithm>

namespace penumbra::stress {

Quad tanh_sinh(const std::function<Quad(Quad)>& f, Quad a, Quad b) {
  // Steps of 1/32 up to t = 4.5, beyond which the weights are below 1e-60.
  constexpr int kSteps = 144;
  const Quad step = Quad(1) / 32, half = (b - a) / 2;
  Quad sum = 0;
  for (int k = -kSteps; k <= kSteps; ++k) {
    const Quad t = k * step, e = exp_q(t), sinh = (e - 1 / e) / 2, cosh = (e + 1 / e) / 2;
    const Quad g = exp_q(-kQuadPi * abs_q(sinh));  // 1 - tanh = 2 g / (1 + g)
    const Quad from_end = half * 2 * g / (1 + g);
    const Quad weight = kQuadPi / 2 * cosh * 4 * g / ((1 + g) * (1 + g));
    if (weight > 0) sum += weight * f(t < 0 ? a + from_end : b - from_end);
  }
  return half * step * sum;
}

Quad tanh_sinh(const std::function<Quad(Quad)>& f, std::vector<Quad> bounds) {
  std::sort(bounds.begin(), bounds.end());
  Quad sum = 0;
  for (std::size_t i = 1; i < bounds.size(); ++i) {
    if (bounds[i] > bounds[i - 1]) sum += tanh_sinh(f, bounds[i - 1], bounds[i]);
  }
  return sum;
}

}  // namespace penumbra::stress
