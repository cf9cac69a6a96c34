#include "tests/support/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

namespace penumbra::statistics {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kTiny = 1e-300;        // stands in for 0 in a continued fraction's denominators
constexpr int kMaxIterations = 100000;  // convergence takes about sqrt(max(a, b)) terms

/// One more term of a continued fraction b0 + a1 / (b1 + a2 / (b2 + ...)) by the modified Lentz method
/// (Thompson and Barnett 1986).
class ContinuedFraction {
 public:
  explicit ContinuedFraction(double b0) : value_(b0 == 0 ? kTiny : b0), c_(value_) {}

  /// Appends a / (b + ...); true once the value no longer changes.
  bool add(double a, double b) {
    d_ = b + a * d_;
    if (std::abs(d_) < kTiny) d_ = kTiny;
    c_ = b + a / c_;
    if (std::abs(c_) < kTiny) c_ = kTiny;
    d_ = 1 / d_;
    const double factor = c_ * d_;
    value_ *= factor;
    return std::abs(factor - 1) < 2 * kEpsilon;
  }
  [[nodiscard]] double value() const { return value_; }

 private:
  double value_, c_, d_ = 0;
};

/// I_x(a, b) where y = 1 - x is known exactly and x <= (a + 1) / (a + b + 2), where the fraction converges
/// fast.
double beta_fraction(double a, double b, double x, double y) {
  ContinuedFraction fraction(1);
  for (int m = 0; m < kMaxIterations; ++m) {
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    fraction.add(odd, 1);
    const double even = (m + 1) * (b - m - 1) * x / ((a + 2 * m + 1) * (a + 2 * m + 2));
    if (fraction.add(even, 1)) break;
  }
  const double log_front =
      a * std::log(x) + b * std::log(y) + std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b);
  return std::exp(log_front) / (a * fraction.value());
}

double regularized_beta(double a, double b, double x, double y) {
  if (x <= 0) return 0;
  if (y <= 0) return 1;
  if (x <= (a + 1) / (a + b + 2)) return beta_fraction(a, b, x, y);
  return 1 - beta_fraction(b, a, y, x);
}

/// The deviation that is left after the allowance for rounding, in standard errors; 0/0 is 0.
double studentize(double difference, double rounding, double standard_error) {
  const double excess = std::abs(difference) - rounding;
  if (excess <= 0) return 0;
  return std::copysign(excess / standard_error, difference);
}

double p_or_failure(double p) { return std::isnan(p) ? 0 : p; }

}  // namespace

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double normal_quantile(double p) {
  if (!(p >= 0 && p <= 1)) return std::numeric_limits<double>::quiet_NaN();
  if (p == 0 || p == 1) return (p == 0 ? -1 : 1) * std::numeric_limits<double>::infinity();
  if (p == 0.5) return 0;
  if (p > 0.5) return -normal_quantile(1 - p);
  // Newton's method on log(cdf), which is concave and increasing: from a start on its left, every step stays
  // there.
  double z = -std::sqrt(-2 * std::log(p));
  for (int i = 0; i < 64; ++i) {
    const double cdf = normal_cdf(z);
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
    const double step = (std::log(p) - std::log(cdf)) * cdf / density;
    z += step;
    if (std::abs(step) <= kEpsilon * std::max(1.0, std::abs(z))) break;
  }
  return z;
}

double regularized_beta(double a, double b, double x) { return regularized_beta(a, b, x, 1 - x); }

double regularized_gamma_q(double a, double x) {
  if (x <= 0) return 1;
  const double log_front = a * std::log(x) - x - std::lgamma(a);
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < kMaxIterations && term > sum * kEpsilon; ++n) {
      term *= x / (a + n);
      sum += term;
    }
    return 1 - std::exp(log_front) * sum;
  }
  ContinuedFraction fraction(x + 1 - a);
  for (int n = 1; n < kMaxIterations; ++n) {
    if (fraction.add(-n * (n - a), x + 2 * n + 1 - a)) break;
  }
  return std::exp(log_front) / fraction.value();
}

double student_two_sided_p(double t, double dof) {
  if (std::isnan(t) || !(dof > 0)) return std::numeric_limits<double>::quiet_NaN();
  if (std::isinf(t)) return 0;
  if (std::isinf(dof)) return std::erfc(std::abs(t) / std::numbers::sqrt2);
  // The fraction does not converge for billions of degrees of freedom, of which Welch makes such where one
  // variance is next to nothing; Abramowitz and Stegun 26.7.8 is off by O(1 / dof^2).
  if (dof > 1e7)
    return std::erfc(std::abs(t) * (1 - 0.25 / dof) / std::sqrt(1 + t * t / (2 * dof)) / std::numbers::sqrt2);
  const double scale = dof + t * t;
  return regularized_beta(dof / 2, 0.5, dof / scale, t * t / scale);
}

double student_to_normal(double t, double dof) {
  const double p = student_two_sided_p(t, dof);
  if (std::isnan(p)) return p;
  return std::copysign(normal_quantile(p / 2), t);
}

double chi_square_p(double x, double dof) {
  if (std::isinf(x)) return 0;
  return regularized_gamma_q(dof / 2, x / 2);
}

double sidak_significance(double significance, std::size_t tests) {
  return -std::expm1(std::log1p(-significance) / double(tests));
}

double sidak_limit(double significance, std::size_t tests) {
  return -normal_quantile(sidak_significance(significance, tests) / 2);
}

void Sample::add(double value) {
  ++count_;
  const double delta = value - mean_;
  mean_ += delta / double(count_);
  m2_ += delta * (value - mean_);
}

double Sample::variance() const {
  if (count_ < 2) return std::numeric_limits<double>::quiet_NaN();
  return m2_ / double(count_ - 1);
}

double Sample::standard_error() const { return std::sqrt(variance() / double(count_)); }

TestResult t_test(const Sample& sample, double expected, double rounding) {
  TestResult result;
  result.dof = double(sample.count()) - 1;
  result.statistic = studentize(sample.mean() - expected, rounding, sample.standard_error());
  result.p = p_or_failure(student_two_sided_p(result.statistic, result.dof));
  return result;
}

TestResult welch_t_test(const Sample& a, const Sample& b, double rounding) {
  const double va = a.variance() / double(a.count()), vb = b.variance() / double(b.count());
  const double na = double(a.count()) - 1, nb = double(b.count()) - 1;
  TestResult result;
  // Two constants have no variance to weigh; the smaller count is the cautious choice.
  result.dof = va + vb > 0 ? (va + vb) * (va + vb) / (va * va / na + vb * vb / nb) : std::min(na, nb);
  result.statistic = studentize(a.mean() - b.mean(), rounding, std::sqrt(va + vb));
  result.p = p_or_failure(student_two_sided_p(result.statistic, result.dof));
  return result;
}

TestResult chi_square_test(std::span<const double> observed, std::span<const double> expected,
                           double min_expected) {
  if (observed.size() != expected.size()) {
    throw std::invalid_argument("chi_square_test: observed and expected differ in length");
  }
  for (std::size_t i = 0; i < observed.size(); ++i) {
    const auto is_count = [](double value) { return std::isfinite(value) && value >= 0; };
    if (!is_count(observed[i]) || !is_count(expected[i])) {
      throw std::invalid_argument("chi_square_test: a count is negative or not finite");
    }
  }
  std::vector<std::size_t> order(observed.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::pair(expected[i], i); });

  struct Pool {
    double observed = 0, expected = 0;
  };
  std::vector<Pool> pools;
  bool impossible = false;
  for (std::size_t i : order) {
    impossible |= expected[i] == 0 && observed[i] > 0;
    if (pools.empty() || pools.back().expected >= min_expected) pools.emplace_back();
    pools.back().observed += observed[i];
    pools.back().expected += expected[i];
  }
  // Equal expectations can leave a last pool below the least one: it joins its neighbour.
  if (pools.size() > 1 && pools.back().expected < min_expected) {
    const Pool last = pools.back();
    pools.pop_back();
    pools.back().observed += last.observed;
    pools.back().expected += last.expected;
  }
  if (pools.size() < 2)
    throw std::invalid_argument("chi_square_test: fewer than two cells expect enough counts");

  TestResult result;
  result.dof = double(pools.size()) - 1;
  for (const Pool& pool : pools) {
    const double difference = pool.observed - pool.expected;
    result.statistic += difference * difference / pool.expected;
  }
  if (impossible) result.statistic = std::numeric_limits<double>::infinity();
  result.p = p_or_failure(chi_square_p(result.statistic, result.dof));
  return result;
}

}  // namespace penumbra::statistics
