// The names of math_double.h in single precision, for shaders, which have no doubles. Built-in functions are
// not used: OpenGL does not specify their accuracy.
#ifndef PENUMBRA_MATH_GLSL_H
#define PENUMBRA_MATH_GLSL_H
#include "kernels/math/math.h"

#define PI_D PI_F
#define HALF_PI_D 1.57079632679f
#define TINY_D 1e-30f
#define ONE_MINUS_EPSILON_D ONE_MINUS_EPSILON

#define min_d min_f
#define max_d max_f
#define clamp_d clamp_f
#define exp_d exp_f
#define log_d log_f
#define log1p_d log1p_f
#define atan2_d atan2_f

/// See exp_and_rest_d.
STRUCT(ExpAndRest) { double power, rest; };
FN ExpAndRest exp_and_rest_of_d(double x) {
  ExpAndRest r;
  r.power = exp_f(x);
  r.rest = -expm1_f(x);
  return r;
}

/// sin x for |x| <= 1.55; relative error below 2e-7. Taylor's series.
FN double sin_d(double x) {
  const double z = x * x;
  return x + x * z *
                 (-1.0f / 6 +
                  z * (1.0f / 120 + z * (-1.0f / 5040 + z * (1.0f / 362880 + z * (-1.0f / 39916800)))));
}

#endif
