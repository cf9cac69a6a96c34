// Statistics for tests: distributions, t-tests, the chi-square test, and the Sidak correction. Each p-value
// is the probability, under the null hypothesis, of a deviation at least as large as the observed one. A test
// at significance .01 fails when p < .01. So a correct implementation fails with one seed in a hundred; tests
// fix their seeds for that reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace penumbra::statistics {

/// Standard normal distribution function, P(Z <= z). Relative error about 1e-15 in both tails.
double normal_cdf(double z);

/// z with normal_cdf(z) = p, for p in (0, 1); minus and plus infinity at 0 and 1; NaN outside.
double normal_quantile(double p);

/// Regularised incomplete beta function I_x(a, b) for a, b > 0 and x in [0, 1]; the continued fraction of
/// DLMF 8.17.22.
double regularized_beta(double a, double b, double x);

/// Upper regularised incomplete gamma function Q(a, x) = Gamma(a, x) / Gamma(a) for a > 0, x >= 0; series
/// DLMF 8.11.4 and continued fraction DLMF 8.9.2.
double regularized_gamma_q(double a, double x);

/// P(|T| >= |t|) for Student's distribution with `dof` > 0 degrees of freedom, not necessarily whole;
/// infinity: the normal distribution.
double student_two_sided_p(double t, double dof);

/// The standard normal deviate that is as improbable as `t` is under Student's distribution, with the sign of
/// `t`.
double student_to_normal(double t, double dof);

/// P(X >= x) for the chi-square distribution with `dof` > 0 degrees of freedom.
double chi_square_p(double x, double dof);

/// The significance of each of `tests` independent tests that makes the chance of any false alarm
/// `significance`: 1 - (1 - significance)^(1/tests) (Sidak 1967).
double sidak_significance(double significance, std::size_t tests);

/// |z| that one of `tests` standard normal deviates exceeds with probability `significance` (two-sided).
double sidak_limit(double significance, std::size_t tests);

/// Count, mean and sum of squared deviations of a sample, accumulated one value at a time (Welford 1962).
class Sample {
 public:
  Sample() = default;
  /// From statistics accumulated elsewhere; `m2` is the sum of squared deviations from the mean.
  Sample(std::uint64_t count, double mean, double m2) : count_(count), mean_(mean), m2_(m2) {}

  void add(double value);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] double variance() const;        ///< unbiased; NaN for fewer than two values
  [[nodiscard]] double standard_error() const;  ///< of the mean

 private:
  std::uint64_t count_ = 0;
  double mean_ = 0;
  double m2_ = 0;
};

struct TestResult {
  double statistic = 0;
  double dof = 0;  ///< degrees of freedom
  double p = 0;    ///< NaN in, 0 out: what cannot be judged has failed
};

/// Two-sided one-sample t-test that the mean of the sampled distribution is `expected`. `rounding` is an
/// absolute allowance for the arithmetic of the values themselves (a bias of single precision, say),
/// subtracted from the deviation; it matters where the sample has little or no variance. At least two values.
TestResult t_test(const Sample& sample, double expected, double rounding = 0);

/// Two-sided two-sample t-test that both means are equal, of unequal variances and counts (Welch 1947).
TestResult welch_t_test(const Sample& a, const Sample& b, double rounding = 0);

/// Pearson's test that counts `observed` come from a distribution that expects `expected` counts (same number
/// of cells, same total). Cells are pooled, smallest expectation first, until each pool expects
/// `min_expected`. A count in a cell that expects exactly 0 has p = 0. Throws std::invalid_argument for
/// negative or non-finite numbers, unequal lengths, or when fewer than two pools remain.
TestResult chi_square_test(std::span<const double> observed, std::span<const double> expected,
                           double min_expected = 5);

}  // namespace penumbra::statistics
