// Microfacet distributions: Beckmann and GGX (Walter et al. 2007), anisotropic (Heitz 2014), and sampling of
// visible normals. Directions are in the frame of the mean normal z; the cosine of wo is above 0.
#ifndef PENUMBRA_MICROFACET_H
#define PENUMBRA_MICROFACET_H
#include "kernels/bsdf/families.h"
#include "kernels/math/math.h"

PENUMBRA_NAMESPACE_BEGIN

// Minimum roughness: below it, directions in single precision are coarser than the lobe.
#define LEAST_ALPHA 1e-4f
#define MOST_ALPHA 100.0f
#define LEAST_FACET_ALPHA 1e-3f  // of OpenPBR
#define INV_SQRT_PI_F 0.564189583547756f

typedef struct {
  int distribution;  ///< DISTRIBUTION_*; if it is a constant, the other distribution costs nothing
  float alpha_u, alpha_v;
} Microfacets;

FN Microfacets make_microfacets(int distribution, float alpha_u, float alpha_v) {
  Microfacets m;
  m.distribution = distribution;
  m.alpha_u = clamp_f(alpha_u, LEAST_ALPHA, MOST_ALPHA);
  m.alpha_v = clamp_f(alpha_v, LEAST_ALPHA, MOST_ALPHA);
  return m;
}

/// Of a roughness in [0, 1] with this anisotropy (OpenPBR 1.1, microfacet model).
FN Microfacets openpbr_microfacets(float roughness, float anisotropy) {
  const float alpha = roughness * roughness, across = 1.0f - anisotropy;
  const float along = alpha * SQRT(2.0f / (1.0f + across * across));
  return make_microfacets(DISTRIBUTION_GGX, max_f(along, LEAST_FACET_ALPHA),
                          max_f(along * across, LEAST_FACET_ALPHA));
}

/// Of a roughness in [0, 1], and a strength in [0, 1] that raises it along the tangent
/// (KHR_materials_anisotropy of glTF).
FN Microfacets gltf_microfacets(float roughness, float strength) {
  const float alpha = roughness * roughness;
  return make_microfacets(DISTRIBUTION_GGX, max_f(mix_f(alpha, 1.0f, strength * strength), LEAST_FACET_ALPHA),
                          max_f(alpha, LEAST_FACET_ALPHA));
}

/// D(h), area per solid angle, for a unit normal h with h.z > 0. It uses squared slopes, since 1 - cos^2
/// loses all digits at low roughness.
FN float microfacet_density(Microfacets m, vec3 h) {
  const float x = h.x / m.alpha_u, y = h.y / m.alpha_v, across = x * x + y * y;
  const float cosine2 = max_f(h.z * h.z, 1e-14f), area = PI_F * (m.alpha_u * m.alpha_v);
  const float sum = across + cosine2;
  const float ggx = 1.0f / (area * (sum * sum));
  const float beckmann = exp_f(-across / cosine2) / (area * (cosine2 * cosine2));
  return m.distribution == DISTRIBUTION_GGX ? ggx : beckmann;
}

/// Length of w's tangential part, in units of the roughness.
FN float microfacet_slant(Microfacets m, vec3 w) { return SQRT(sqr(m.alpha_u * w.x) + sqr(m.alpha_v * w.y)); }

/// erfc(x) / exp(-x^2) for x >= 0, with an absolute error of 1.5e-7 in erfc (Abramowitz and Stegun 1964,
/// 7.1.26).
FN float erfc_over_gauss(float x) {
  const float t = 1.0f / (1.0f + 0.3275911f * x);
  return t *
         (0.254829592f + t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f))));
}

/// x with erfc(x) = w, for 1e-9 < w < 2; exact to a few roundings of x (Giles 2012).
FN float inverse_erfc(float w) {
  const float l = -log_f(w * (2.0f - w)), a = l - 2.5f, b = SQRT(max_f(l, 0.0f)) - 3.0f;
  const float low =
      1.50140941f +
      a * (0.246640727f +
           a * (-0.00417768164f +
                a * (-0.00125372503f +
                     a * (0.00021858087f +
                          a * (-4.39150654e-06f +
                               a * (-3.5233877e-06f + a * (3.43273939e-07f + a * 2.81022636e-08f)))))));
  const float high =
      2.83297682f +
      b * (1.00167406f +
           b * (0.00943887047f +
                b * (-0.0076224613f +
                     b * (0.00573950773f +
                          b * (-0.00367342844f +
                               b * (0.00134934322f + b * (0.000100950558f + b * -0.000200214257f)))))));
  return (l < 5.0f ? low : high) * (1.0f - w);
}

/// Smith's masking G1(w) / w.z, for w.z > 0: G1 is the fraction of the microfacets facing w that w sees. For
/// Beckmann it is Walter's rational approximation, with an error of up to 0.35% and values above 1 by up to
/// 6e-5, which Mitsuba has made part of the model.
FN float microfacet_masking_over_cosine(Microfacets m, vec3 w) {
  const float slant = microfacet_slant(m, w);
  const float ggx = 2.0f / (w.z + SQRT(w.z * w.z + slant * slant));
  const bool masks = w.z < 1.6f * slant;
  const float a = masks ? w.z / (masks ? slant : 1.0f) : 1.6f;
  const float rational = (3.535f + 2.181f * a) / (1.0f + a * (2.276f + 2.577f * a));
  const float beckmann = masks ? rational / (masks ? slant : 1.0f) : 1.0f / w.z;
  return m.distribution == DISTRIBUTION_GGX ? ggx : beckmann;
}
FN float microfacet_masking(Microfacets m, vec3 w) { return microfacet_masking_over_cosine(m, w) * w.z; }

/// The same without approximation: the distribution of the normals that sample_microfacet samples.
FN float microfacet_visible_over_cosine(Microfacets m, vec3 w) {
  const float slant = microfacet_slant(m, w), c = w.z / max_f(slant, 1e-6f * w.z);
  const float gauss = exp_f(-c * c), below = 2.0f - erfc_over_gauss(c) * gauss;  // 1 + erf c
  const float beckmann = 2.0f / (below * w.z + (INV_SQRT_PI_F * gauss) * slant);
  const float ggx = 2.0f / (w.z + SQRT(w.z * w.z + slant * slant));
  return m.distribution == DISTRIBUTION_GGX ? ggx : beckmann;
}

/// Pdf per solid angle with which sample_microfacet samples the unit normal h, which faces wo.
FN float microfacet_pdf(Microfacets m, vec3 wo, vec3 h) {
  return microfacet_density(m, h) * (microfacet_visible_over_cosine(m, wo) * max_f(dot3(wo, h), 0.0f));
}

/// microfacet_masking(m, wo) over the exact masking; 1 except for Beckmann's approximation.
FN float microfacet_masking_ratio(Microfacets m, vec3 wo) {
  const float ratio = microfacet_masking_over_cosine(m, wo) / microfacet_visible_over_cosine(m, wo);
  return m.distribution == DISTRIBUTION_GGX ? 1.0f : ratio;
}

/// Samples the slope of a visible normal along the direction of wo, whose stretched cotangent is c > 0;
/// roughness 1. The distribution function is (c w + exp(-x^2) / sqrt(pi)) / (the same at c), with w =
/// erfc(-x). It is solved for w, in which it is nearly linear, by three Newton steps (after Jakob 2014, who
/// uses 1 - w, which has no digits left in the tail). The error is 3e-6 in u.
FN float beckmann_visible_slope(float c, float u) {
  const float gauss = exp_f(-c * c), most = 2.0f - erfc_over_gauss(c) * gauss;
  const float target = u * (c * most + INV_SQRT_PI_F * gauss);
  float w = most * (u * erfc_over_gauss(safe_sqrt(-log_f(u))));
  UNROLL
  for (int k = 0; k < 3; k++) {
    const float x = -inverse_erfc(w);
    const float excess = c * w + INV_SQRT_PI_F * exp_f(-x * x) - target;
    w = clamp_f(w - excess / max_f(c - x, 1e-6f), 1e-9f, most);
  }
  return -inverse_erfc(min_f(w, 1.9999999f));
}

/// Samples a visible normal, unit, z > 0, with density proportional to D(h) max(0, wo . h): see
/// microfacet_pdf. GGX: Dupuy and Benyoub 2023, as a spherical cap; Beckmann: Heitz and d'Eon 2014.
FN vec3 sample_microfacet(Microfacets m, vec3 wo, float u, float v) {
  const vec3 stretched = normalize3(make_vec3(m.alpha_u * wo.x, m.alpha_v * wo.y, wo.z));
  // GGX: the sum of the stretched wo and a point of the cap with heights from -stretched.z on.
  float sine, cosine;
  sincos_2pi(v, &sine, &cosine);
  const float depth = u * (1.0f + stretched.z), r = safe_sqrt(depth * (2.0f - depth));
  const vec3 ggx =
      make_vec3(r * cosine + stretched.x, r * sine + stretched.y, (1.0f - u) * (1.0f + stretched.z));
  // Beckmann: slopes along and perpendicular to the stretched wo.
  const float slant = SQRT(sqr(stretched.x) + sqr(stretched.y));
  const bool slanted = slant > 1e-6f * stretched.z;
  const float shorten = 1.0f / (slanted ? slant : 1.0f);
  const float along_x = slanted ? stretched.x * shorten : 1.0f,
              along_y = slanted ? stretched.y * shorten : 0.0f;
  const float c = stretched.z / max_f(slant, 1e-6f * stretched.z);
  const float along = beckmann_visible_slope(c, max_f(u, 2.98023224e-8f));
  const float across = -inverse_erfc(clamp_f(2.0f * v, 5.9604645e-8f, 1.9999999f));
  const vec3 beckmann =
      make_vec3(-(along * along_x - across * along_y), -(along * along_y + across * along_x), 1.0f);
  const vec3 h = select3(m.distribution == DISTRIBUTION_GGX, ggx, beckmann);
  return normalize3(make_vec3(m.alpha_u * h.x, m.alpha_v * h.y, h.z));
}

/// Reflection by perfectly reflecting microfacets, between wo and wi, both above the surface.
typedef struct {
  float f_cos;   ///< f cos(wi), without the Fresnel factor
  float pdf;     ///< of wi, by sampling a visible normal and mirroring wo about it
  float cosine;  ///< between either direction and the half vector: the angle of the Fresnel factor
} MicrofacetReflection;

FN MicrofacetReflection microfacet_reflection(Microfacets m, vec3 wo, vec3 wi) {
  const vec3 sum = add(wo, wi);
  const vec3 h = scale(sum, 1.0f / SQRT(max_f(dot3(sum, sum), 1e-30f)));
  const float quarter = 0.25f * microfacet_density(m, h);
  MicrofacetReflection r;
  r.f_cos = quarter * (microfacet_masking_over_cosine(m, wo) * microfacet_masking(m, wi));
  r.pdf = quarter * microfacet_visible_over_cosine(m, wo);
  r.cosine = dot3(wo, h);
  return r;
}

/// wo mirrored about the unit normal h.
FN vec3 mirror_about(vec3 wo, vec3 h) { return sub(scale(h, 2.0f * dot3(wo, h)), wo); }

/// wo refracted by a facet with unit normal h, at `cosine` before and `refracted` after; `ior` as for
/// dielectric_fresnel. The result is normalised: otherwise rounding errors of wo would grow by 1 / ior each
/// time.
FN vec3 refract_about(vec3 wo, vec3 h, float cosine, float refracted, float ior) {
  const float shrink = 1.0f / ior;
  return normalize3(sub(scale(h, cosine * shrink - refracted), scale(wo, shrink)));
}

/// f cos / pdf of a reflection, without the Fresnel factor.
FN float microfacet_weight(Microfacets m, vec3 wo, vec3 wi) {
  return microfacet_masking(m, wi) * microfacet_masking_ratio(m, wo);
}

PENUMBRA_NAMESPACE_END
#endif
