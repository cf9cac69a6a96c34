// Elementary functions in plain IEEE double, for closed forms. They give the same bits on every target. They
// have no branches and no conversions between doubles and integers (for which SSE2 and AVX2 have no vector
// instructions), so that lane loops vectorise. Errors are relative to the exact result, measured over the
// stated range by math_double_test. The polynomials interpolate at Chebyshev points, in 60 digits.
#ifndef PENUMBRA_MATH_DOUBLE_H
#define PENUMBRA_MATH_DOUBLE_H
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

#define PI_D 3.14159265358979323846
#define HALF_PI_D 1.57079632679489661923
#define LN2_HIGH_D 0.6931471803691238  // 31 bits: exact times an exponent
#define LN2_LOW_D 1.9082149292705877e-10
#define SMALLEST_D 2.2250738585072014e-308       // smallest normal number
#define TINY_D 1e-300                            // negligible in sums, but far above denormal numbers
#define ONE_MINUS_EPSILON_D 0.99999999999999989  // the largest double below 1

FN double min_d(double a, double b) { return a < b ? a : b; }
FN double max_d(double a, double b) { return a > b ? a : b; }
FN double clamp_d(double x, double low, double high) { return min_d(max_d(x, low), high); }
/// sqrt(max(x, 0))
FN double safe_sqrt_d(double x) { return SQRT_D(max_d(x, 0.0)); }

/// e^x as 2^n (1 + m): returns 2^n and m = e^r - 1 for the remainder r, |r| <= ln(2) / 2. For |x| <= 708.
FN double exp_parts_d(double x, PRIVATE double* m) {
  // Adding 1.5 * 2^52 rounds to an integer and leaves it in the lowest bits.
  const double shifted = x * 1.4426950408889634 + 6755399441055744.0;
  const double n = shifted - 6755399441055744.0;
  const double r = (x - n * LN2_HIGH_D) - n * LN2_LOW_D;
  const double r2 = r * r, r4 = r2 * r2;
  const double p0 =
      (0.5000000000000001 + r * 0.16666666666666669) + r2 * (0.04166666666662413 + r * 0.008333333333330062);
  const double p4 = (0.0013888888917213717 + r * 0.00019841269863053618) +
                    r2 * (2.4801521295954376e-05 + r * 2.7557268459997064e-06);
  const double p8 = 2.7620088445409746e-07 + r * 2.510038549551032e-08;
  *m = r + r2 * (p0 + r4 * (p4 + r4 * p8));
  return BITS_DOUBLE((DOUBLE_BITS(shifted) + 1023ul) << 52);
}

/// e^x, 0 below -708 and at most e^708; relative error below 2.3e-16.
FN double exp_d(double x) {
  double m;
  const double power = exp_parts_d(clamp_d(x, -708.0, 708.0), &m);
  return x < -708.0 ? 0.0 : power + power * m;
}

/// e^x and 1 - e^x for x <= 0, the latter without cancellation; relative errors below 2.3e-16 and 3.5e-16.
/// e^x is 0 below -708.
FN double exp_and_rest_d(double x, PRIVATE double* rest) {
  double m;
  const double power = exp_parts_d(max_d(x, -708.0), &m);
  const double product = power * m;
  *rest = x < -708.0 ? 1.0 : (1.0 - power) - product;
  return x < -708.0 ? 0.0 : power + product;
}

/// Both as a struct.
STRUCT(ExpAndRest) { double power, rest; };
FN ExpAndRest exp_and_rest_of_d(double x) {
  ExpAndRest r;
  r.power = exp_and_rest_d(x, &r.rest);
  return r;
}

/// log(1 + f) for 1 + f in [1/sqrt 2, sqrt 2], by 2 atanh(f / (2 + f)).
FN double log_core_d(double f) {
  const double s = f / (2.0 + f);
  const double z = s * s, z2 = z * z;
  const double low =
      (0.666666666666667 + z * 0.399999999998995) + z2 * (0.2857142862597826 + z * 0.22222211134341624);
  const double high = (0.18182889158299903 + z * 0.15331720502376558) + z2 * 0.1461646325895801;
  return s * (2.0 + z * (low + (z2 * z2) * high));
}

/// Splits normal x > 0 into 2^e m with m in [1/sqrt 2, sqrt 2); returns e.
FN double log_exponent_d(double x, PRIVATE double* m) {
  // 0x3fe6a09e667f3bcd are the bits of 1/sqrt 2.
  const ulong bits = DOUBLE_BITS(x) + (0x3ff0000000000000ul - 0x3fe6a09e667f3bcdul);
  *m = BITS_DOUBLE((bits & 0x000ffffffffffffful) + 0x3fe6a09e667f3bcdul);
  // The biased exponent e in the lowest bits of 2^52 makes 2^52 + e.
  return BITS_DOUBLE((bits >> 52) | 0x4330000000000000ul) - (4503599627370496.0 + 1023.0);
}

/// log x for normal x > 0; relative error below 5e-16.
FN double log_d(double x) {
  double m;
  const double e = log_exponent_d(x, &m);
  return e * LN2_HIGH_D + (e * LN2_LOW_D + log_core_d(m - 1.0));
}

/// log(1 + x) for x > -1 (at least -1 + 2^-53); relative error below 6e-16, near 0 too.
FN double log1p_d(double x) {
  double m;
  const double e = log_exponent_d(1.0 + x, &m);
  // If the exponent is 0, x itself is more accurate than the rounded 1 + x.
  const double f = e == 0.0 ? x : m - 1.0;
  return e * LN2_HIGH_D + (e * LN2_LOW_D + log_core_d(f));
}

/// atan2(y, x) in [-pi, pi]; 0 for (0, 0); zeros of either sign are 0. Relative error below 4e-16 for
/// arguments whose quotient does not underflow.
FN double atan2_d(double y, double x) {
  const double ax = FABS_D(x), ay = FABS_D(y);
  const bool steep = ay > ax;
  const double low = steep ? ax : ay, high = steep ? ay : ax;
  // Above pi / 8: the tangent of the angle minus pi / 4.
  const bool upper = low > 0.41421356237309503 * high;
  const double numerator = upper ? low - high : low;
  const double denominator = upper ? low + high : high;
  const double v = numerator / (denominator > 0.0 ? denominator : 1.0);
  const double z = v * v, z2 = z * z, z4 = z2 * z2;
  const double p0 =
      (-0.3333333333333333 + z * 0.1999999999999552) + z2 * (-0.14285714284666542 + z * 0.11111111015256361);
  const double p4 =
      (-0.09090904578123903 + z * 0.07692183190826087) + z2 * (-0.06664511447381948 + z * 0.0585814891280221);
  const double p8 = (-0.0508544973794026 + z * 0.03923165829558719) + z2 * -0.01917688711906226;
  const double p = v + v * (z * (p0 + z4 * (p4 + z4 * p8)));
  double a = upper ? 0.78539816339744831 + p : p;
  a = steep ? HALF_PI_D - a : a;
  a = x < 0.0 ? PI_D - a : a;
  return y < 0.0 ? -a : a;
}

/// sin x for |x| <= 1.55; relative error below 3e-16.
FN double sin_d(double x) {
  const double z = x * x, z2 = z * z;
  const double low = (-0.16666666666666666 + z * 0.00833333333333332) +
                     z2 * (-0.00019841269841257164 + z * 2.7557319219762468e-06);
  const double high = (-2.5052107694312943e-08 + z * 1.6058982391553107e-10) +
                      z2 * (-7.644134610377607e-13 + z * 2.7335208854328903e-15);
  return x + x * (z * (low + (z2 * z2) * high));
}

PENUMBRA_NAMESPACE_END
#endif
