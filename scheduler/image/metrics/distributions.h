// Probabilities for the z-test and quantiles for confidence intervals.
#pragma once

namespace penumbra {

/// P(|Z| >= |z|) of a standard normal Z. NaN for NaN.
double normal_two_sided_p(double z);

/// The z >= 0 with normal_two_sided_p(z) = p, for p in (0, 1].
double normal_two_sided_quantile(double p);

/// P(X >= x) of the chi-square distribution with `dof` > 0 degrees of freedom. 1 for x <= 0, NaN for NaN.
double chi_square_p(double x, double dof);

/// P(T <= t) of Student's distribution with `dof` > 0 degrees of freedom.
double student_t_cdf(double t, double dof);

/// The t with student_t_cdf(t, dof) = p, for p in (0, 1) and dof > 0.
double student_t_quantile(double p, double dof);

}  // namespace penumbra
