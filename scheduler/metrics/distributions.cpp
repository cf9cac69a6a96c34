#include "scheduler/metrics/distributions.h"

#include <cmath>

namespace penumbra {
namespace {

constexpr int kMostTerms = 1'000'000;  // about 10 sqrt(a) are needed where x is near a
constexpr double kEnough = 1e-16;
constexpr double kTiny = 1e-300;

/// log(x^a e^-x / Gamma(a)).
double log_scale(double a, double x) { return a * std::log(x) - x - std::lgamma(a); }

/// P(a, x) by DLMF 8.11.4, for x < a + 1.
double lower_series(double a, double x) {
  double term = 1 / a, sum = term;
  for (int n = 1; n < kMostTerms && term > sum * kEnough; ++n) sum += term *= x / (a + n);
  return std::exp(log_scale(a, x)) * sum;
}

/// Q(a, x) by the continued fraction DLMF 8.9.2, evaluated after Lentz, for x >= a + 1.
double upper_fraction(double a, double x) {
  double b = x + 1 - a, c = 1 / kTiny, d = 1 / b, value = d;
  for (int n = 1; n < kMostTerms; ++n) {
    const double numerator = -n * (n - a);
    b += 2;
    d = numerator * d + b;
    c = b + numerator / c;
    if (std::abs(d) < kTiny) d = kTiny;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1 / d;
    value *= d * c;
    if (std::abs(d * c - 1) < 4 * kEnough) break;
  }
  return std::exp(log_scale(a, x)) * value;
}

}  // namespace

double normal_two_sided_p(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

double chi_square_p(double x, double dof) {
  if (std::isnan(x)) return x;
  if (x <= 0) return 1;
  if (std::isinf(x)) return 0;
  const double a = 0.5 * dof, t = 0.5 * x;
  return t < a + 1 ? 1 - lower_series(a, t) : upper_fraction(a, t);
}

}  // namespace penumbra
