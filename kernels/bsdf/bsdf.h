// BSDFs. All are one record, a diffuse and a Phong lobe, so that a lane loop over mixed materials stays
// straight; a scene without Phong compiles only the first. `n` is the unit shading normal on the viewer's
// side; f is in 1/sr, pdfs per solid angle.
#ifndef PENUMBRA_BSDF_H
#define PENUMBRA_BSDF_H
#include "kernels/math/frame.h"
#include "kernels/math/lane_record.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// max(0, cos alpha)^exponent, alpha between the unit vectors a and b: from their difference, since the power
/// of a rounded cosine near 1 loses all digits at exponents of 1e4.
FN float cosine_power(vec3 a, vec3 b, float exponent) {
  const vec3 difference = sub(a, b);
  const float versine = 0.5f * dot3(difference, difference);
  const float power = exp_f(exponent * log1p_f(-min_f(versine, 0.9999999f)));
  return versine < 1.0f ? power : 0.0f;
}

FN vec3 mirror_direction(vec3 n, vec3 wo) { return sub(scale(n, 2.0f * dot3(n, wo)), wo); }

#define BSDF_VALUE_FIELDS(F, a)                     \
  F(a, vec3, f_cos) /* f times the cosine of wi */ \
  F(a, float, pdf)  /* of sample_bsdf choosing wi */
LANE_RECORD(BsdfValue, BsdfValues, bsdf_value, BSDF_VALUE_FIELDS)

/// Value and density for a pair of directions; both 0 unless both are on the normal's side.
FN BsdfValue eval_bsdf(GLOBAL const Material* m, vec3 n, vec3 wo, vec3 wi) {
  const float cosine = dot3(n, wi);
  const bool reflects = (cosine > 0.0f) & (dot3(n, wo) > 0.0f);
  const float lambert = cosine * INV_PI_F;
  BsdfValue value;
  value.f_cos = scale(load3(&m->diffuse), lambert);
  value.pdf = lambert;
#if HAS(PHONG)
  const float lobe = cosine_power(mirror_direction(n, wo), wi, m->exponent) * (0.5f * INV_PI_F);
  value.f_cos = add(value.f_cos, scale(load3(&m->specular), (m->exponent + 2.0f) * lobe * cosine));
  value.pdf = (1.0f - m->lobe) * lambert + m->lobe * ((m->exponent + 1.0f) * lobe);
#endif
  value.f_cos = select3(reflects, value.f_cos, make_vec3(0.0f, 0.0f, 0.0f));
  value.pdf = reflects ? value.pdf : 0.0f;
  return value;
}

#define BSDF_SAMPLE_FIELDS(F, a)       \
  F(a, vec3, wi)                       \
  F(a, vec3, weight) /* f cos / pdf */ \
  F(a, float, pdf)   /* 0: no direction */
LANE_RECORD(BsdfSample, BsdfSamples, bsdf_sample, BSDF_SAMPLE_FIELDS)

/// Samples `wi` with the density that eval_bsdf reports.
FN BsdfSample sample_bsdf(GLOBAL const Material* m, vec3 n, vec3 wo, float u, float v, float choice) {
  BsdfSample s;
  s.wi = sample_cosine_hemisphere(n, u, v);
#if HAS(PHONG)
  const float power = log_f(1.0f - u) / (m->exponent + 1.0f);
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const float r = safe_sqrt(-expm1_f(2.0f * power));
  const vec3 around = from_frame(mirror_direction(n, wo), r * cosine, r * sine, exp_f(power));
  s.wi = select3(choice < m->lobe, around, s.wi);
#endif
  const BsdfValue value = eval_bsdf(m, n, wo, s.wi);
  s.pdf = value.pdf;
  const bool some = s.pdf > 0.0f;
  s.weight = scale(value.f_cos, 1.0f / (some ? s.pdf : 1.0f));
  // A diffuse BSDF's quotient is its reflectance exactly.
#if HAS(PHONG)
  s.weight = select3(some & (m->lobe == 0.0f), load3(&m->diffuse), s.weight);
#else
  s.weight = select3(some, load3(&m->diffuse), s.weight);
#endif
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
