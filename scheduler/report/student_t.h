// Student's t distribution, for confidence intervals of fitted slopes.
#pragma once

namespace penumbra {

/// P(T <= t) for `dof` > 0 degrees of freedom; relative error of the smaller tail about 1e-13.
double student_t_cdf(double t, double dof);

/// The t with student_t_cdf(t, dof) = p, for p in (0, 1) and dof > 0.
double student_t_quantile(double p, double dof);

}  // namespace penumbra
