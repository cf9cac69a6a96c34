// Dielectric boundaries: a smooth one, a thin pane of two, and rough ones. A smooth one reflects by Fresnel's
// equations and refracts the rest by Snell's law. `ior` is the index of the side opposite wo over that of
// wo's side.
#ifndef PENUMBRA_DIELECTRIC_H
#define PENUMBRA_DIELECTRIC_H
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/bsdf/microfacet.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// Probability of reflection, which is sampled if `choice` is below it.
FN float dielectric_lobe_probability(Closure c, vec3 wo) {
  return dielectric_fresnel(wo.z, c.ior).reflectance;
}

FN BsdfValue dielectric_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return no_bsdf_value();
}

/// Radiance that is refracted into a medium scales with the square of the relative index (Veach 1997, section
/// 5.2).
FN BsdfSample dielectric_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                float choice) {
  const DielectricFresnel f = dielectric_fresnel(wo.z, c.ior);
  const bool reflects = choice < f.reflectance;
  const float shrink = 1.0f / c.ior;
  const vec3 reflected = make_vec3(-wo.x, -wo.y, wo.z);
  const vec3 refracted = make_vec3(-wo.x * shrink, -wo.y * shrink, -f.cosine);
  BsdfSample s = no_bsdf_sample();
  s.wi = select3(reflects, reflected, refracted);
  s.weight = select3(reflects, c.specular, scale(c.transmitted, shrink * shrink));
  s.pdf = wo.z > 0.0f ? DELTA_PDF : 0.0f;
  s.eta = reflects ? 1.0f : c.ior;
  return s;
}

// A pane of two parallel smooth boundaries, so thin that it does not displace rays. Light that is reflected
// inside any number of times is included.

/// Reflectance of a pane whose boundaries reflect r each and pass t = 1 - r: r + t^2 r + t^2 r^3 + ... = 2 r
/// / (1 + r).
FN float reflectance_of_two(float r) { return 2.0f * r / (1.0f + r); }

/// Reflectance of a pane with this relative index at a cosine above 0.
FN float pane_reflectance(float cosine, float ior) {
  return reflectance_of_two(dielectric_fresnel(cosine, ior).reflectance);
}

/// Probability of reflection, which is sampled if `choice` is below it.
FN float thindielectric_lobe_probability(Closure c, vec3 wo) { return pane_reflectance(wo.z, c.ior); }

FN BsdfValue thindielectric_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return no_bsdf_value();
}

FN BsdfSample thindielectric_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                    float choice) {
  const bool reflects = choice < thindielectric_lobe_probability(c, wo);
  BsdfSample s = no_bsdf_sample();
  s.wi = select3(reflects, make_vec3(-wo.x, -wo.y, wo.z), negate(wo));
  s.weight = select3(reflects, c.specular, c.transmitted);
  s.pdf = wo.z > 0.0f ? DELTA_PDF : 0.0f;
  return s;
}

// Rough dielectric boundaries (Walter et al. 2007): microfacets that reflect or refract by Fresnel's
// equations, one family for each distribution. `ior` is as for smooth dielectrics, but must not be close to
// 1, where directions no longer determine normals.

FN BsdfValue dielectric_lobe_eval(Microfacets m, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = wi.z > 0.0f;
  const float n = reflects ? 1.0f : c.ior;
  const vec3 sum = add_scaled(wo, n, wi);
  const float length2 = max_f(dot3(sum, sum), 1e-30f);
  const vec3 h = scale(sum, (sum.z < 0.0f ? -1.0f : 1.0f) / SQRT(length2));
  const float cosine = dot3(wo, h), other = dot3(wi, h);
  const float reflectance = dielectric_fresnel(cosine, c.ior).reflectance;
  // The Jacobian from h to wi: 1 / (4 cosine), or n^2 |other| / |wo + n wi|^2 (Walter et al., equation 17).
  // Refracted radiance is larger than the arriving one by 1 / n^2.
  const float share = reflects ? reflectance : 1.0f - reflectance;
  const float stretch = reflects ? 0.25f : cosine * (FABS(other) / length2);
  const float density = microfacet_density(m, h) * (share * stretch);
  const vec3 wi_above = make_vec3(wi.x, wi.y, FABS(wi.z));
  const float masking = microfacet_masking_over_cosine(m, wo) * microfacet_masking(m, wi_above);
  BsdfValue value;
  value.f_cos = scale(select3(reflects, c.specular, c.transmitted), density * masking);
  value.pdf = density * (microfacet_visible_over_cosine(m, wo) * (n * n));
  const bool faces = (cosine > 0.0f) & (reflects ? wi.z > 0.0f : BOTH(wi.z < 0.0f, other < 0.0f));
  return select_bsdf_value((wo.z > 0.0f) & faces, value, no_bsdf_value());
}

FN BsdfSample dielectric_lobe_sample(Microfacets m, Closure c, vec3 wo, float u, float v, float choice) {
  const vec3 h = sample_microfacet(m, wo, u, v);
  const float cosine = dot3(wo, h), n = c.ior, shrink = 1.0f / n;
  const DielectricFresnel f = dielectric_fresnel(cosine, n);
  const bool reflects = choice < f.reflectance;
  const vec3 refracted = refract_about(wo, h, cosine, f.cosine, n);
  BsdfSample s = no_bsdf_sample();
  s.wi = select3(reflects, mirror_about(wo, h), refracted);
  // |wo + n wi| = cosine - n f.cosine = (1 - n^2) / (cosine + n f.cosine).
  const float sum = (n - 1.0f) * (n + 1.0f) / max_f(cosine + n * f.cosine, 1e-15f);
  const float stretch = reflects ? 0.25f : cosine * f.cosine * sqr(n / sum);
  const float share = reflects ? f.reflectance : 1.0f - f.reflectance;
  const float pdf = microfacet_density(m, h) * microfacet_visible_over_cosine(m, wo) * (share * stretch);
  const bool faces = (wo.z > 0.0f) & (cosine > 0.0f) & (reflects ? s.wi.z > 0.0f : s.wi.z < 0.0f);
  const vec3 wi_above = make_vec3(s.wi.x, s.wi.y, FABS(s.wi.z));
  const float weight = microfacet_weight(m, wo, wi_above);
  const vec3 colour = select3(reflects, c.specular, scale(c.transmitted, shrink * shrink));
  s.weight = scale(colour, faces ? weight : 0.0f);
  s.pdf = faces ? pdf : 0.0f;
  s.eta = reflects ? 1.0f : n;
  return s;
}

#define ROUGH_DIELECTRIC(name, NAME)                                                            \
  FN BsdfValue name##_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {           \
    const Microfacets m = make_microfacets(DISTRIBUTION_##NAME, c.alpha_u, c.alpha_v);          \
    return dielectric_lobe_eval(m, c, wo, wi);                                                  \
  }                                                                                             \
  FN BsdfSample name##_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, \
                              float choice) {                                                   \
    const Microfacets m = make_microfacets(DISTRIBUTION_##NAME, c.alpha_u, c.alpha_v);          \
    return dielectric_lobe_sample(m, c, wo, u, v, choice);                                      \
  }
ROUGH_DIELECTRIC(roughdielectric_ggx, GGX)
ROUGH_DIELECTRIC(roughdielectric_beckmann, BECKMANN)
#undef ROUGH_DIELECTRIC

PENUMBRA_NAMESPACE_END
#endif
