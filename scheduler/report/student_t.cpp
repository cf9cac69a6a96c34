#include "scheduler/report/student_t.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace penumbra {
namespace {

/// Continued fraction of the incomplete beta function by Lentz' algorithm; converges fast for
/// x < (a + 1) / (a + b + 2). DLMF 8.17.22.
double beta_fraction(double a, double b, double x) {
  constexpr int kMaxTerms = 10000;
  constexpr double kTiny = 1e-300;
  const auto guarded = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
  double c = 1, d = 1 / guarded(1 - (a + b) * x / (a + 1)), value = d;
  for (int m = 1; m <= kMaxTerms; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    double change = 1;
    for (const double term : {even, odd}) {
      d = 1 / guarded(1 + term * d);
      c = guarded(1 + term / c);
      change = c * d;
      value *= change;
    }
    if (std::abs(change - 1) < std::numeric_limits<double>::epsilon()) break;
  }
  return value;
}

/// I_x(a, b); `y` is 1 - x, given apart because the difference loses digits.
double regularized_beta(double a, double b, double x, double y) {
  if (x <= 0) return 0;
  if (y <= 0) return 1;
  const double log_front =
      std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log(y);
  if (x < (a + 1) / (a + b + 2)) return std::exp(log_front) * beta_fraction(a, b, x) / a;
  return 1 - std::exp(log_front) * beta_fraction(b, a, y) / b;
}

}  // namespace

double student_t_cdf(double t, double dof) {
  const double square = t * t;
  const double tail = 0.5 * regularized_beta(0.5 * dof, 0.5, dof / (dof + square), square / (dof + square));
  return t < 0 ? tail : 1 - tail;
}

double student_t_quantile(double p, double dof) {
  if (p == 0.5) return 0;  // the cdf cannot tell a tiny t from 0
  if (p < 0.5) return -student_t_quantile(1 - p, dof);
  double low = 0, high = 1;
  while (student_t_cdf(high, dof) < p && high < 1e300) high *= 2;
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (student_t_cdf(middle, dof) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace penumbra
