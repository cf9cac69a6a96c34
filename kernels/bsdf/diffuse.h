// Diffuse reflection: Lambert's, f = diffuse / pi, and that of rough surfaces; diffuse sheets.
#ifndef PENUMBRA_DIFFUSE_H
#define PENUMBRA_DIFFUSE_H
#include "kernels/bsdf/families.h"
#include "kernels/math/frame.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

FN BsdfValue diffuse_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  BsdfValue value;
  value.pdf = reflects ? wi.z * INV_PI_F : 0.0f;
  value.f_cos = scale(c.diffuse, value.pdf);
  return value;
}

FN BsdfSample diffuse_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, float choice) {
  BsdfSample s = no_bsdf_sample();
  s.wi = cosine_hemisphere(u, v);
  s.pdf = diffuse_eval(scene, c, wo, s.wi).pdf;
  s.weight = c.diffuse;
  return s;
}

// Rough diffuse surfaces: long V-shaped cavities whose Lambertian facets have normally distributed slopes
// (Oren and Nayar 1994). `alpha_u` is the root mean square slope, sqrt(2) sigma, as in Mitsuba 0.6. The full
// model includes light that is reflected twice in a cavity; of white facets it reflects up to 3 % more than
// arrives next to the horizon. The fast one is their "qualitative" model without that light.

/// pi f = single * diffuse + twice * diffuse^2.
typedef struct {
  float single, twice;
} CavityReflection;

FN CavityReflection cavity_reflection(float sigma2, bool is_fast, vec3 wo, vec3 wi) {
  const float sine_o = SQRT(wo.x * wo.x + wo.y * wo.y), sine_i = SQRT(wi.x * wi.x + wi.y * wi.y);
  const float across = sine_o * sine_i;
  const float between = across > 1e-20f ? clamp_f((wo.x * wi.x + wo.y * wi.y) / across, -1.0f, 1.0f) : 0.0f;
  const float theta_o = atan2_f(sine_o, wo.z), theta_i = atan2_f(sine_i, wi.z);
  const float high = max_f(theta_o, theta_i), low = min_f(theta_o, theta_i);
  const float sine_high = max_f(sine_o, sine_i);
  // Tangents of the smaller and of the mean angle, bounded next to the horizon.
  const float tangent_low = min_f(sine_o, sine_i) / max_f(max_f(wo.z, wi.z), 1e-10f);
  const float tangent_mean = (sine_o + sine_i) / max_f(wo.z + wi.z, 1e-10f);

  const float base = 1.0f - 0.5f * sigma2 / (sigma2 + 0.33f), slope = 0.45f * sigma2 / (sigma2 + 0.09f);
  const float of_low = low * (2.0f * INV_PI_F), of_both = of_low * (high * (2.0f * INV_PI_F));
  const float behind = between < 0.0f ? of_low * of_low * of_low : 0.0f;
  const float between_planes = 0.125f * sigma2 / (sigma2 + 0.09f) * (of_both * of_both) * tangent_mean;
  const float full =
      base + between * (slope * (sine_high - behind) * tangent_low) + (1.0f - FABS(between)) * between_planes;
  const float fast = base + max_f(between, 0.0f) * (slope * sine_high * tangent_low);
  CavityReflection r;
  r.single = is_fast ? fast : full;
  r.twice = is_fast ? 0.0f : 0.17f * sigma2 / (sigma2 + 0.13f) * (1.0f - between * (of_low * of_low));
  return r;
}

FN BsdfValue roughdiffuse_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  const CavityReflection r =
      cavity_reflection(0.5f * c.alpha_u * c.alpha_u, c.variant == ROUGHDIFFUSE_FAST, wo, wi);
  const vec3 f = mul(c.diffuse, add_scaled(make_vec3(r.single, r.single, r.single), r.twice, c.diffuse));
  BsdfValue value;
  value.pdf = wi.z * INV_PI_F;
  // Where both directions are next to the horizon, the fit of the full model may fall below 0.
  value.f_cos = scale(max3(f, make_vec3(0.0f, 0.0f, 0.0f)), value.pdf);
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

FN BsdfSample roughdiffuse_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                  float choice) {
  const vec3 wi = cosine_hemisphere(u, v);
  return sample_of_value(wi, roughdiffuse_eval(scene, c, wo, wi));
}

// A thin sheet that scatters light evenly to both sides: f = diffuse / pi for reflection, transmitted / pi
// for transmission. Both sides are alike.

/// Probability of reflection.
FN float difftrans_reflected_share(Closure c) {
  const float reflected = luminance(c.diffuse), sum = reflected + luminance(c.transmitted);
  return sum > 0.0f ? reflected / sum : 1.0f;
}

FN BsdfValue difftrans_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = wi.z > 0.0f;
  const float lambert = FABS(wi.z) * INV_PI_F, share = difftrans_reflected_share(c);
  BsdfValue value;
  value.pdf = (reflects ? share : 1.0f - share) * lambert;
  value.f_cos = scale(select3(reflects, c.diffuse, c.transmitted), lambert);
  return select_bsdf_value((wo.z > 0.0f) & (wi.z != 0.0f), value, no_bsdf_value());
}

FN BsdfSample difftrans_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                               float choice) {
  const vec3 above = cosine_hemisphere(u, v);
  const bool reflects = choice < difftrans_reflected_share(c);
  const vec3 wi = make_vec3(above.x, above.y, reflects ? above.z : -above.z);
  return sample_of_value(wi, difftrans_eval(scene, c, wo, wi));
}

PENUMBRA_NAMESPACE_END
#endif
