// Fresnel's equations for unpolarised light, in forms without cancellation.
#ifndef PENUMBRA_FRESNEL_H
#define PENUMBRA_FRESNEL_H
#include "kernels/math/math.h"
#include "kernels/math/vec3.h"

PENUMBRA_NAMESPACE_BEGIN

typedef struct {
  float reflectance;  ///< in [0, 1]; 1: total internal reflection
  float cosine;       ///< >= 0, between the refracted direction and the normal of its side
} DielectricFresnel;

/// For light at `cosine` >= 0 at the boundary to a medium of refractive index `ior` > 0, relative to its own.
/// By (c - n t)(c + n t) = 1 - n^2 and (n c - t)(n c + t) = (n^2 - 1) ((n^2 + 1) c^2 - 1) / n^2, with t^2 =
/// (c^2 + n^2 - 1) / n^2: accurate for n near 1, and at grazing angles.
FN DielectricFresnel dielectric_fresnel(float cosine, float ior) {
  const float excess = (ior - 1.0f) * (ior + 1.0f), ior2 = ior * ior, cosine2 = cosine * cosine;
  const float refracted2 = (cosine2 + excess) / ior2;
  const bool total = (excess < 0.0f) & !(refracted2 > 0.0f);
  DielectricFresnel f;
  f.cosine = safe_sqrt(refracted2);
  const float across = cosine + ior * f.cosine, along = ior * cosine + f.cosine;
  const float s = excess / max_f(across * across, 1e-30f);
  const float p = excess * ((ior2 + 1.0f) * cosine2 - 1.0f) / max_f(ior2 * (along * along), 1e-30f);
  f.reflectance = total ? 1.0f : min_f(0.5f * (s * s + p * p), 1.0f);
  return f;
}

/// Reflectance of a conductor of refractive index eta - i k, relative to the outside, at `cosine` >= 0. With
/// a - i b = sqrt((eta - i k)^2 - sin^2), all terms are sums of squares (Born and Wolf 1999, section 14.2).
FN float conductor_reflectance(float cosine, float eta, float k) {
  const float cosine2 = cosine * cosine, sine2 = (1.0f - cosine) * (1.0f + cosine);
  const float real = (eta - k) * (eta + k) - sine2, imaginary = 2.0f * eta * k;
  const float magnitude = SQRT(real * real + imaginary * imaginary);
  const float larger = SQRT(0.5f * (magnitude + FABS(real)));
  const float smaller = 0.5f * imaginary / max_f(larger, 1e-20f);
  const float a = real >= 0.0f ? larger : smaller, b = real >= 0.0f ? smaller : larger;
  const float b2 = b * b;
  const float s = (sqr(a - cosine) + b2) / max_f(sqr(a + cosine) + b2, 1e-30f);
  const float p =
      (sqr(a * cosine - sine2) + b2 * cosine2) / max_f(sqr(a * cosine + sine2) + b2 * cosine2, 1e-30f);
  return min_f(0.5f * s * (1.0f + p), 1.0f);
}

/// The same for RGB.
FN vec3 conductor_fresnel(float cosine, vec3 eta, vec3 k) {
  return make_vec3(conductor_reflectance(cosine, eta.x, k.x), conductor_reflectance(cosine, eta.y, k.y),
                   conductor_reflectance(cosine, eta.z, k.z));
}

PENUMBRA_NAMESPACE_END
#endif
