// Elementary functions in plain float arithmetic. Unlike libm and OpenCL's built-ins they give the same bits
// on every target, and they have no branches, so that lane loops vectorise. Errors are relative to the exact
// result, measured over the stated range by math_test.
#ifndef PENUMBRA_MATH_H
#define PENUMBRA_MATH_H
#include "kernels/lang.h"

PENUMBRA_NAMESPACE_BEGIN

#define PI_F 3.14159265358979f
#define INV_PI_F 0.318309886183791f
#define ONE_MINUS_EPSILON 0.99999994f  // the largest float below 1
#define HALF_EPSILON 5.9604645e-8f     // 2^-24: relative rounding error of one operation
#define NO_LIMIT 1e30f                 // tmax of an unlimited ray
#define INFINITE BITS_FLOAT(0x7f800000u)

FN float min_f(float a, float b) { return a < b ? a : b; }
FN float max_f(float a, float b) { return a > b ? a : b; }
FN float clamp_f(float x, float low, float high) { return min_f(max_f(x, low), high); }
/// Interpolates from a (t = 0) to b (t = 1), both exactly.
FN float mix_f(float a, float b, float t) { return (1.0f - t) * a + t * b; }
FN int min_i(int a, int b) { return a < b ? a : b; }
FN int max_i(int a, int b) { return a > b ? a : b; }
FN float sqr(float x) { return x * x; }
/// sqrt(max(x, 0))
FN float safe_sqrt(float x) { return SQRT(max_f(x, 0.0f)); }
/// 1 or -1; 1 for 0.
FN float sign_of(float x) { return x < 0.0f ? -1.0f : 1.0f; }
/// The largest integer not above x. From 2^23 on every float is an integer. NaN gives an arbitrary number.
FN float floor_f(float x) {
  const bool small = FABS(x) < 8388608.0f;
  const float cut = TO_FLOAT(TO_INT(small ? x : 0.0f));
  const float below = cut > x ? cut - 1.0f : cut;
  return small ? below : x;
}

#ifndef PENUMBRA_GLSL
/// sin and cos of 2 pi u for |u| <= 2; absolute error below 1.2e-7. The reduction to octants is exact, since
/// 4u is.
FN void sincos_2pi(float u, PRIVATE float* s, PRIVATE float* c) {
  float q = u * 4.0f;
  int k = (int)(q + (q >= 0.0f ? 0.5f : -0.5f));
  float y = (q - (float)k) * 1.57079632679f;
  float y2 = y * y;
  float sy = y * (1.0f + y2 * (-1.0f / 6 + y2 * (1.0f / 120 + y2 * (-1.0f / 5040 + y2 * (1.0f / 362880)))));
  float cy =
      1.0f +
      y2 * (-0.5f + y2 * (1.0f / 24 + y2 * (-1.0f / 720 + y2 * (1.0f / 40320 - y2 * (1.0f / 3628800)))));
  float ss = (k & 1) ? cy : sy;
  float cc = (k & 1) ? sy : cy;
  *s = (k & 2) ? -ss : ss;
  *c = ((k + 1) & 2) ? -cc : cc;
}
#endif

/// e^x, 0 below -87.3 and at most e^88; relative error below 2.6e-7.
FN float exp_f(float x) {
  float y = clamp_f(x, -87.3f, 88.0f);
  float q = y * 1.44269504089f;
  int n = TO_INT(q + (q >= 0.0f ? 0.5f : -0.5f));
  float r =
      (y - TO_FLOAT(n) * 0.693359375f) - TO_FLOAT(n) * -2.12194440e-4f;  // ln 2 in two parts (Cody and Waite)
  float p =
      1.0f + r * (1.0f + r * (0.5f + r * (1.0f / 6 + r * (1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720))))));
  float e = p * BITS_FLOAT(TO_UINT(n + 127) << 23);
  return x < -87.3f ? 0.0f : e;
}

/// log(1 + f) for 1 + f in [1/sqrt 2, sqrt 2], by 2 atanh(f / (2 + f)).
FN float log_core(float f) {
  float s = f / (2.0f + f);
  float z = s * s;
  return s * (2.0f + z * (2.0f / 3 + z * (2.0f / 5 + z * (2.0f / 7 + z * (2.0f / 9)))));
}

/// log x for normal x > 0; relative error below 2.3e-7.
FN float log_f(float x) {
  uint bits = FLOAT_BITS(x);
  int e = TO_INT(bits >> 23) - 127;
  float m = BITS_FLOAT((bits & 0x007fffffu) | 0x3f800000u);
  bool high = m > 1.41421356f;
  m = high ? 0.5f * m : m;
  e = high ? e + 1 : e;
  return TO_FLOAT(e) * 0.693359375f + (TO_FLOAT(e) * -2.12194440e-4f + log_core(m - 1.0f));
}

/// log(1 + x) for x > -1; relative error below 3e-7, near 0 too.
FN float log1p_f(float x) {
  bool near = BOTH(x > -0.25f, x < 0.4f);
  float small = log_core(near ? x : 0.0f);
  float large = log_f(max_f(1.0f + x, 1.2e-38f));
  return near ? small : large;
}

/// e^x - 1; relative error below 8e-7, near 0 below 3e-7.
FN float expm1_f(float x) {
  bool near = FABS(x) < 0.35f;
  float y = near ? x : 0.0f;
  float small =
      y * (1.0f + y * (0.5f + y * (1.0f / 6 + y * (1.0f / 24 + y * (1.0f / 120 +
                                                                    y * (1.0f / 720 + y * (1.0f / 5040)))))));
  return near ? small : exp_f(x) - 1.0f;
}

/// atan2(y, x) in [-pi, pi]; 0 for (0, 0); relative error below 3e-7. Polynomial: Moshier, Cephes atanf.
FN float atan2_f(float y, float x) {
  float ax = FABS(x), ay = FABS(y);
  bool steep = ay > ax;
  float num = steep ? ax : ay, den = steep ? ay : ax;
  float t = den > 0.0f ? num / den : 0.0f;
  bool upper = t > 0.414213562f;
  float v = upper ? (t - 1.0f) / (t + 1.0f) : t;
  float z = v * v;
  float p = v + v * z *
                    (-3.33329491539e-1f +
                     z * (1.99777106478e-1f + z * (-1.38776856032e-1f + z * 8.05374449538e-2f)));
  float a = upper ? 0.785398163397f + p : p;
  a = steep ? 1.57079632679f - a : a;
  a = x < 0.0f ? PI_F - a : a;
  return y < 0.0f ? -a : a;
}

PENUMBRA_NAMESPACE_END
#endif
