// Tail probabilities for the z-test.
#pragma once

namespace penumbra {

/// P(|Z| >= |z|) of a standard normal Z. NaN for NaN.
double normal_two_sided_p(double z);

/// P(X >= x) of the chi-square distribution with `dof` > 0 degrees of freedom; relative error about 1e-8 for
/// up to 1e7 of them. 1 for x <= 0, NaN for NaN.
double chi_square_p(double x, double dof);

}  // namespace penumbra
