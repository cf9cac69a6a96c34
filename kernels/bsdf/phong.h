// Lambert and a normalised Phong lobe: f = diffuse / pi + specular (n + 2) / (2 pi) max(0, cos alpha)^n,
// alpha between wi and the mirror direction of wo (Lafortune and Willems 1994).
#ifndef PENUMBRA_PHONG_H
#define PENUMBRA_PHONG_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/microfacet.h"
#include "kernels/math/frame.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// max(0, cos alpha)^exponent for the angle alpha between the unit vectors a and b. It uses their difference,
/// since the power of a rounded cosine near 1 loses all digits at exponents of 1e4.
FN float cosine_power(vec3 a, vec3 b, float exponent) {
  const vec3 difference = sub(a, b);
  const float versine = 0.5f * dot3(difference, difference);
  const float power = exp_f(exponent * log1p_f(-min_f(versine, 0.9999999f)));
  return versine < 1.0f ? power : 0.0f;
}

/// Probability of sampling the lobe: its share in the mean reflectances.
FN float phong_lobe_share(Closure c) {
  const float lobe = (c.specular.x + c.specular.y) + c.specular.z;
  const float sum = ((c.diffuse.x + c.diffuse.y) + c.diffuse.z) + lobe;
  return sum > 0.0f ? lobe / sum : 0.0f;
}

FN BsdfValue phong_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  const float lambert = wi.z * INV_PI_F;
  const float lobe = cosine_power(make_vec3(-wo.x, -wo.y, wo.z), wi, c.exponent) * (0.5f * INV_PI_F);
  BsdfValue value;
  value.f_cos = add(scale(c.diffuse, lambert), scale(c.specular, (c.exponent + 2.0f) * lobe * wi.z));
  const float share = phong_lobe_share(c);
  value.pdf = (1.0f - share) * lambert + share * ((c.exponent + 1.0f) * lobe);
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

/// Samples the pdf (n + 1) / (2 pi) cos^n about the unit vector `axis`, n the exponent.
FN vec3 sample_cosine_power(vec3 axis, float exponent, float u, float v) {
  const float power = log_f(1.0f - u) / (exponent + 1.0f);
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const float r = safe_sqrt(-expm1_f(2.0f * power));
  return from_frame(axis, r * cosine, r * sine, exp_f(power));
}

FN BsdfSample phong_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, float choice) {
  const vec3 around = sample_cosine_power(make_vec3(-wo.x, -wo.y, wo.z), c.exponent, u, v);
  const vec3 wi = select3(choice < phong_lobe_share(c), around, cosine_hemisphere(u, v));
  return sample_of_value(wi, phong_eval(scene, c, wo, wi));
}

// Lambert and a normalised Blinn-Phong lobe: f = diffuse / pi + specular k cos^n of the angle between normal
// and half vector. With k = (n + 2) (n + 4) / (8 pi (2^(-n/2) + n)) the lobe's albedo is exactly `specular`
// for wo along the normal, and less for all other directions (Giesen 2009).

FN BsdfValue blinnphong_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  const float n = c.exponent;
  const vec3 sum = add(wo, wi);
  const float length = SQRT(max_f(dot3(sum, sum), 1e-24f));
  const float power = cosine_power(scale(sum, 1.0f / length), make_vec3(0.0f, 0.0f, 1.0f), n);
  const float lambert = wi.z * INV_PI_F, share = phong_lobe_share(c);
  const float norm = 0.125f * (n + 2.0f) * ((n + 4.0f) / (exp_f(-0.346573590f * n) + n));
  BsdfValue value;
  value.f_cos = scale(add(c.diffuse, scale(c.specular, norm * power)), lambert);
  // Half vectors have pdf (n + 1) / (2 pi) cos^n; |wo + wi| = 2 wo . h.
  value.pdf = (1.0f - share) * lambert + share * ((n + 1.0f) * power * (0.25f * INV_PI_F) / length);
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

FN BsdfSample blinnphong_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                float choice) {
  const float power = log_f(1.0f - u) / (c.exponent + 1.0f);
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const float r = safe_sqrt(-expm1_f(2.0f * power));
  const vec3 h = make_vec3(r * cosine, r * sine, exp_f(power));
  const vec3 mirrored = mirror_about(wo, h);
  const vec3 wi = select3(choice < phong_lobe_share(c), mirrored, cosine_hemisphere(u, v));
  return sample_of_value(wi, blinnphong_eval(scene, c, wo, wi));
}

PENUMBRA_NAMESPACE_END
#endif
