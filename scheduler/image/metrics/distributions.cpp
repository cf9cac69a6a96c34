#include "scheduler/image/metrics/distributions.h"

#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

namespace penumbra {

double normal_two_sided_p(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

double normal_two_sided_quantile(double p) { return std::sqrt(2.0) * boost::math::erfc_inv(p); }

double chi_square_p(double x, double dof) {
  if (std::isnan(x)) return x;
  if (x <= 0) return 1;
  if (std::isinf(x)) return 0;
  // Where x is tiny, Boost divides by a gamma function, which thousands of degrees of freedom make infinite:
  // the quotient is 0 all the same.
  namespace policies = boost::math::policies;
  constexpr policies::policy<policies::overflow_error<policies::ignore_error>> kInfinityIsFine;
  return boost::math::gamma_q(0.5 * dof, 0.5 * x, kInfinityIsFine);
}

double student_t_cdf(double t, double dof) { return boost::math::cdf(boost::math::students_t(dof), t); }

double student_t_quantile(double p, double dof) {
  return boost::math::quantile(boost::math::students_t(dof), p);
}

}  // namespace penumbra
