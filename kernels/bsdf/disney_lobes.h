// Lobes of Disney's BSDFs (Burley 2012, "Physically Based Shading at Disney"; Burley 2015, "Extending the
// Disney BRDF to a BSDF with Integrated Subsurface Scattering"). The families principled, principledthin and
// disney combine them.
#ifndef PENUMBRA_DISNEY_LOBES_H
#define PENUMBRA_DISNEY_LOBES_H
#include "kernels/bsdf/control_lobes.h"
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/bsdf/microfacet.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

/// Schlick's weight (1 - cosine)^5, which interpolates Fresnel reflectances to 1 (Schlick 1994).
FN float schlick_weight(float cosine) {
  const float m = clamp_f(1.0f - cosine, 0.0f, 1.0f), m2 = m * m;
  return m2 * m2 * m;
}

/// Schlick's weight at a boundary of relative refractive index `ior`. If the other side has the lower index,
/// the cosine of the `refracted` direction is used.
FN float schlick_weight_of(float ior, float cosine, float refracted) {
  return schlick_weight(ior > 1.0f ? cosine : refracted);
}

/// Reflectance along the normal for relative refractive index `ior`.
FN float normal_reflectance(float ior) { return sqr((ior - 1.0f) / (ior + 1.0f)); }

/// A colour scaled to luminance 1; white for black.
FN vec3 disney_tint(vec3 colour, float its_luminance) {
  const bool lit = its_luminance > 0.0f;
  return select3(lit, scale(colour, 1.0f / (lit ? its_luminance : 1.0f)), make_vec3(1.0f, 1.0f, 1.0f));
}

/// GGX microfacets (Burley 2012, 5.4) with a roughness of at least 1e-3.
FN Microfacets disney_microfacets(float roughness, float anisotropic) {
  const float square = roughness * roughness, aspect = SQRT(1.0f - 0.9f * anisotropic);
  return make_microfacets(DISTRIBUTION_GGX, max_f(square / aspect, 1e-3f), max_f(square * aspect, 1e-3f));
}

/// Pdf of reflected directions by sampling visible normals: the density of the normals that wo sees, over 4
/// times the normal's cosine with wo.
FN float reflected_density(Microfacets m, vec3 wo, vec3 h) {
  return 0.25f * microfacet_density(m, h) * microfacet_masking_over_cosine(m, wo);
}

/// Masking of the direction w, on either side.
FN float masking_of_either_side(Microfacets m, vec3 w) {
  return microfacet_masking(m, make_vec3(w.x, w.y, FABS(w.z)));
}

/// pi f of the diffuse lobe for base colour 1. `flatness` interpolates from the retroreflecting form (Burley
/// 2012, 5.3; equation 4 of Burley 2015 is the same) to an approximation of subsurface scattering after
/// Hanrahan and Krueger. The cosines of the directions are above 0; cos_h is that of either with the half
/// vector.
FN float disney_diffuse(float cos_o, float cos_i, float cos_h, float roughness, float flatness) {
  const float weight_o = schlick_weight(cos_o), weight_i = schlick_weight(cos_i);
  const float at_90 = roughness * cos_h * cos_h;
  const float dull = mix_f(1.0f, 0.5f + 2.0f * at_90, weight_o) * mix_f(1.0f, 0.5f + 2.0f * at_90, weight_i);
  const float flat_fresnel = mix_f(1.0f, at_90, weight_o) * mix_f(1.0f, at_90, weight_i);
  const float flat = 1.25f * (flat_fresnel * (1.0f / max_f(cos_o + cos_i, 1e-30f) - 0.5f) + 0.5f);
  return mix_f(dull, flat, flatness);
}

/// Probabilities of the lobes; they sum to 1.
typedef struct {
  float diffuse, clearcoat, specular;
} DisneyShares;

FN DisneyShares disney_shares(float diffuse, float clearcoat, float specular) {
  const float sum = diffuse + clearcoat + specular;
  const float scaled = sum > 0.0f ? 1.0f / sum : 0.0f;
  DisneyShares shares;
  shares.diffuse = diffuse * scaled;
  shares.clearcoat = clearcoat * scaled;
  shares.specular = specular * scaled;
  return shares;
}

/// pi f of the diffuse lobe for the cosine of wo, approximately averaged over wi: at a cosine of 0.7 for wi,
/// perpendicular in azimuth.
FN float mean_disney_diffuse(float cosine, float roughness, float flatness) {
  return disney_diffuse(max_f(cosine, 1e-6f), 0.7f, SQRT(0.5f + 0.35f * cosine), roughness, flatness);
}
/// The microfacets as a transformed cosine; anisotropic ones are replaced by isotropic ones of the same area.
FN MicrofacetLobe disney_lobe(const PRIVATE Scene* scene, Closure c, float cosine) {
  const Microfacets m = disney_microfacets(c.roughness, c.anisotropic);
  return microfacet_lobe(scene, DISTRIBUTION_GGX, SQRT(m.alpha_u * m.alpha_v), cosine);
}

// --- The clearcoat: generalised Trowbridge-Reitz microfacets with exponent 1 (Burley 2012, B.2), reflectance
// 0.04 along the normal, and GGX masking with alpha 0.25.

#define CLEARCOAT_REFLECTANCE 0.04f
#define CLEARCOAT_MASKING_ALPHA 0.25f

FN float clearcoat_alpha(float gloss) { return mix_f(0.1f, 0.001f, gloss); }

/// The paper's D: density of the microfacets' normals h per solid angle, times their cosine. It uses the half
/// vector's sine, since 1 - cos^2 has no digits left at the lobe's centre.
FN float gtr1_density(float alpha, vec3 h) {
  const float a2 = alpha * alpha, logarithm = log_f(a2);
  const float norm = a2 < 1.0f ? (a2 - 1.0f) / logarithm : 1.0f;
  return norm * INV_PI_F / (a2 * (h.z * h.z) + (h.x * h.x + h.y * h.y));
}

/// Samples a normal with pdf gtr1_density times its cosine.
FN vec3 gtr1_sample(float alpha, float u, float v) {
  const float a2 = alpha * alpha;
  // sin^2 = (a2^(1-u) - a2) / (1 - a2), without cancellation.
  const float inverted = a2 * expm1_f(-u * log_f(a2)) / (1.0f - a2);
  const float sine2 = min_f(a2 < 1.0f ? inverted : u, 1.0f);
  const float r = SQRT(sine2);
  float s, c;
  sincos_2pi(v, &s, &c);
  return make_vec3(r * c, r * s, SQRT(1.0f - sine2));
}

/// The masked lobe D F G / 4, and the pdf of sampling it by gtr1_sample, for unit directions with half vector
/// h on the same side. `weight` is Schlick's for the angle with h.
typedef struct {
  float value, pdf;
} Clearcoat;

FN Clearcoat clearcoat_lobe(float gloss, float weight, vec3 wo, vec3 wi, vec3 h) {
  const float density = gtr1_density(clearcoat_alpha(gloss), h);
  const Microfacets ggx =
      make_microfacets(DISTRIBUTION_GGX, CLEARCOAT_MASKING_ALPHA, CLEARCOAT_MASKING_ALPHA);
  const float masking = masking_of_either_side(ggx, wo) * masking_of_either_side(ggx, wi);
  Clearcoat coat;
  coat.value = 0.25f * density * masking * mix_f(CLEARCOAT_REFLECTANCE, 1.0f, weight);
  coat.pdf = 0.25f * density * h.z / max_f(dot3(wo, h), 1e-30f);
  return coat;
}

PENUMBRA_NAMESPACE_END
#endif
