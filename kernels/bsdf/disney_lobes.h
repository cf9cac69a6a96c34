// What Disney's BSDFs are made of (Burley 2012, "Physically Based Shading at Disney"; Burley 2015, "Extending
// the Disney BRDF to a BSDF with Integrated Subsurface Scattering"): the families principled, principledthin
// and disney weigh these.
#ifndef PENUMBRA_DISNEY_LOBES_H
#define PENUMBRA_DISNEY_LOBES_H
#include "kernels/bsdf/control_lobes.h"
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/bsdf/microfacet.h"
#include "kernels/math/frame.h"

PENUMBRA_NAMESPACE_BEGIN

/// (1 - cosine)^5: how far Fresnel reflectances have grown to 1 (Schlick 1994).
FN float schlick_weight(float cosine) {
  const float m = clamp_f(1.0f - cosine, 0.0f, 1.0f), m2 = m * m;
  return m2 * m2 * m;
}

/// The same at a boundary of relative refractive index `ior`: where the other side is the thinner, of the
/// `refracted` direction's cosine.
FN float schlick_weight_of(float ior, float cosine, float refracted) {
  return schlick_weight(ior > 1.0f ? cosine : refracted);
}

/// Reflectance along the normal between media of that relative refractive index.
FN float normal_reflectance(float ior) { return sqr((ior - 1.0f) / (ior + 1.0f)); }

/// The hue of a colour, of luminance 1; white for black.
FN vec3 disney_tint(vec3 colour, float its_luminance) {
  const bool lit = its_luminance > 0.0f;
  return select3(lit, scale(colour, 1.0f / (lit ? its_luminance : 1.0f)), make_vec3(1.0f, 1.0f, 1.0f));
}

/// GGX microfacets (Burley 2012, 5.4); their roughness is at least 1e-3.
FN Microfacets disney_microfacets(float roughness, float anisotropic) {
  const float square = roughness * roughness, aspect = SQRT(1.0f - 0.9f * anisotropic);
  return make_microfacets(DISTRIBUTION_GGX, max_f(square / aspect, 1e-3f), max_f(square * aspect, 1e-3f));
}

/// Density of the microfacets' normals that wo sees, over 4 times the cosine that such a normal has with wo:
/// the density of its reflections.
FN float reflected_density(Microfacets m, vec3 wo, vec3 h) {
  return 0.25f * microfacet_density(m, h) * microfacet_masking_over_cosine(m, wo);
}

/// Masking of the direction w on either side.
FN float masking_of_either_side(Microfacets m, vec3 w) {
  return microfacet_masking(m, make_vec3(w.x, w.y, FABS(w.z)));
}

/// pi f of the diffuse lobe of base colour 1: from its retroreflecting form (Burley 2012, 5.3; Burley 2015,
/// equation 4, is the same) to that flattened like scattering beneath the surface, after Hanrahan and
/// Krueger. Cosines of the directions, above 0, and of either with their half vector.
FN float disney_diffuse(float cos_o, float cos_i, float cos_h, float roughness, float flatness) {
  const float weight_o = schlick_weight(cos_o), weight_i = schlick_weight(cos_i);
  const float at_90 = roughness * cos_h * cos_h;
  const float dull = mix_f(1.0f, 0.5f + 2.0f * at_90, weight_o) * mix_f(1.0f, 0.5f + 2.0f * at_90, weight_i);
  const float flat_fresnel = mix_f(1.0f, at_90, weight_o) * mix_f(1.0f, at_90, weight_i);
  const float flat = 1.25f * (flat_fresnel * (1.0f / max_f(cos_o + cos_i, 1e-30f) - 0.5f) + 0.5f);
  return mix_f(dull, flat, flatness);
}

/// How often lobes are chosen; they sum to 1.
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

/// pi f of the diffuse lobe for a viewer's cosine, about its mean over the light's directions: at theirs of
/// 0.7, at right angles to the viewer.
FN float mean_disney_diffuse(float cosine, float roughness, float flatness) {
  return disney_diffuse(max_f(cosine, 1e-6f), 0.7f, SQRT(0.5f + 0.35f * cosine), roughness, flatness);
}
/// The microfacets as a lobe; of anisotropic ones the round one of the same size.
FN MicrofacetLobe disney_lobe(const PRIVATE Scene* scene, Closure c, float cosine) {
  const Microfacets m = disney_microfacets(c.roughness, c.anisotropic);
  return microfacet_lobe(scene, DISTRIBUTION_GGX, SQRT(m.alpha_u * m.alpha_v), cosine);
}

// --- The clearcoat: generalised Trowbridge-Reitz microfacets with exponent 1 (Burley 2012, B.2), reflectance
// 0.04 along the normal, and the masking of GGX with alpha 0.25.

#define CLEARCOAT_REFLECTANCE 0.04f
#define CLEARCOAT_MASKING_ALPHA 0.25f

FN float clearcoat_alpha(float gloss) { return mix_f(0.1f, 0.001f, gloss); }

/// Density of the microfacets' normals h, per solid angle, times their cosine: D of the paper. The sine is
/// the half vector's own, since 1 - cos^2 has no digits where the lobe is.
FN float gtr1_density(float alpha, vec3 h) {
  const float a2 = alpha * alpha, logarithm = log_f(a2);
  const float norm = a2 < 1.0f ? (a2 - 1.0f) / logarithm : 1.0f;
  return norm * INV_PI_F / (a2 * (h.z * h.z) + (h.x * h.x + h.y * h.y));
}

/// A normal of density gtr1_density times its cosine.
FN vec3 gtr1_sample(float alpha, float u, float v) {
  const float a2 = alpha * alpha;
  // sin^2 = (a2^(1-u) - a2) / (1 - a2), without its cancellation.
  const float inverted = a2 * expm1_f(-u * log_f(a2)) / (1.0f - a2);
  const float sine2 = min_f(a2 < 1.0f ? inverted : u, 1.0f);
  const float r = SQRT(sine2);
  float s, c;
  sincos_2pi(v, &s, &c);
  return make_vec3(r * c, r * s, SQRT(1.0f - sine2));
}

/// Its masked lobe: D F G / 4, and the density of sampling it by gtr1_sample; for unit directions whose half
/// vector is h, on its side. `weight`: Schlick's, at the angle with h.
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
