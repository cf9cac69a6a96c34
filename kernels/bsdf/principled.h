// The principled BSDF of Mitsuba 3, after Burley (2012, 2015). `metallic` interpolates from a dielectric to a
// metal; `spec_trans` interpolates the dielectric from opaque and diffuse to transmitting. Its GGX
// microfacets reflect and refract. A clearcoat and sheen are on top.
//
// There is a family for opaque ones and one for those that transmit.
//
// From inside (`variant`) it is only a rough dielectric without colour, as far as it transmits. Base colour
// is `diffuse`; `ior` is as for smooth dielectrics.
//
// It follows Mitsuba down to its clearcoat, which lacks the 1 / (4 cos cos) of a microfacet model: it is
// brighter than that of `disney` along the normal, and darker at grazing angles.
#ifndef PENUMBRA_PRINCIPLED_H
#define PENUMBRA_PRINCIPLED_H
#include "kernels/bsdf/disney_lobes.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// The parts that do not depend on directions.
typedef struct {
  bool inside;
  float brdf, bsdf;     // weights of diffuse reflection and of transmission
  DisneyShares shares;  // sampling probabilities; the specular lobe reflects and transmits,
  float transmits;      // the latter with this times the Fresnel transmittance as probability
  Microfacets facets;
} Principled;

/// `can_transmit` is a constant: which of the two families it is.
FN Principled principled_of(Closure c, bool can_transmit) {
  Principled p;
  p.inside = can_transmit & (c.variant == PRINCIPLED_INSIDE);
  const float spec_trans = can_transmit ? c.spec_trans : 0.0f;
  const float dielectric = 1.0f - c.metallic;
  p.brdf = dielectric * (1.0f - spec_trans);
  p.bsdf = dielectric * spec_trans;
  p.transmits = p.inside ? 1.0f : p.bsdf;
  p.shares = disney_shares(p.inside ? 0.0f : p.brdf * c.diffuse_rate,
                           p.inside ? 0.0f : 0.25f * c.clearcoat * c.clearcoat_rate,
                           p.inside ? 1.0f : c.specular_rate);
  p.facets = disney_microfacets(c.roughness, c.anisotropic);
  return p;
}

/// Reflectance of the microfacets, where those of a dielectric reflect `fresnel`. Metallic and tinted parts
/// use Schlick's approximation with this weight.
FN vec3 principled_fresnel(Closure c, Principled p, float fresnel, float weight, vec3 tint) {
  const vec3 white = make_vec3(1.0f, 1.0f, 1.0f);
  const float dielectric = 1.0f - c.metallic;
  const vec3 metal = mix3(c.diffuse, white, weight);
  const vec3 tinted = mix3(scale(tint, normal_reflectance(c.ior)), white, weight);
  const float plain = dielectric * (1.0f - c.spec_tint) * fresnel;
  vec3 outside = add_scaled(make_vec3(plain, plain, plain), c.metallic, metal);
  outside = add_scaled(outside, dielectric * c.spec_tint, tinted);
  const float within = p.bsdf * fresnel;
  return select3(p.inside, make_vec3(within, within, within), outside);
}

FN BsdfValue principled_lobes_eval(Closure c, Principled p, bool can_transmit, vec3 wo, vec3 wi) {
  const bool reflects = !can_transmit | (wi.z > 0.0f);
  const vec3 sum = add_scaled(wo, reflects ? 1.0f : c.ior, wi);
  const float length2 = dot3(sum, sum);
  const float to_unit = 1.0f / SQRT(max_f(length2, 1e-30f));
  const vec3 h = scale(sum, sum.z < 0.0f ? -to_unit : to_unit);
  const float cos_o = dot3(wo, h), cos_i = dot3(wi, h);
  const bool there = (wo.z > 0.0f) & (length2 > 0.0f) & (cos_o > 0.0f);
  const bool facets_reflect = there & (wi.z > 0.0f) & (cos_i > 0.0f);
  const bool facets_transmit = can_transmit & there & (wi.z < 0.0f) & (cos_i < 0.0f);

  const DielectricFresnel boundary = dielectric_fresnel(FABS(cos_o), c.ior);
  const float fresnel = boundary.reflectance;
  const float weight = schlick_weight_of(c.ior, cos_o, boundary.cosine);
  const float density = reflected_density(p.facets, wo, h);
  const float masked = density * masking_of_either_side(p.facets, wi);
  const vec3 tint = disney_tint(c.diffuse, luminance(c.diffuse));

  // Reflection by the microfacets.
  const vec3 reflected = principled_fresnel(c, p, fresnel, weight, tint);
  vec3 f_cos = scale(reflected, facets_reflect ? masked : 0.0f);
  const float share_transmitted = p.transmits * (1.0f - fresnel);
  const float specular_pdf = p.shares.specular * density;
  float pdf = facets_reflect ? specular_pdf * (1.0f - share_transmitted) : 0.0f;

  // Transmission: the radiance is that of the other side over eta^2.
  const float jacobian = 4.0f * cos_o * FABS(cos_i) * (to_unit * to_unit);
  const float through = p.bsdf * (1.0f - fresnel) * masked * jacobian;
  const vec3 root = make_vec3(SQRT(c.diffuse.x), SQRT(c.diffuse.y), SQRT(c.diffuse.z));
  f_cos = add_scaled(f_cos, facets_transmit ? through : 0.0f, root);
  pdf += facets_transmit ? specular_pdf * share_transmitted * (c.ior * c.ior) * jacobian : 0.0f;

  // Lobes that exist outside only.
  const bool outside = there & (wi.z > 0.0f) & !p.inside;
  const float cosine = outside ? wi.z : 0.0f;
  const float diffuse = disney_diffuse(wo.z, FABS(wi.z), cos_i, c.roughness, c.flatness);
  f_cos = add_scaled(f_cos, p.brdf * INV_PI_F * diffuse * cosine, c.diffuse);
  pdf += p.shares.diffuse * INV_PI_F * cosine;
  const vec3 sheen = mix3(make_vec3(1.0f, 1.0f, 1.0f), tint, c.sheen_tint);
  const float sheens = (p.brdf > 0.0f ? c.sheen * (1.0f - c.metallic) : 0.0f) * schlick_weight(cos_i);
  f_cos = add_scaled(f_cos, sheens * cosine, sheen);
  const Clearcoat coat = clearcoat_lobe(c.clearcoat_gloss, weight, wo, wi, h);
  const float coat_cos = c.clearcoat * coat.value * cosine;
  f_cos = add(f_cos, make_vec3(coat_cos, coat_cos, coat_cos));
  pdf += outside ? p.shares.clearcoat * coat.pdf : 0.0f;
  BsdfValue value;
  value.f_cos = f_cos;
  value.pdf = pdf;
  return select_bsdf_value(there, value, no_bsdf_value());
}

FN BsdfSample principled_lobes_sample(Closure c, bool can_transmit, vec3 wo, float u, float v, float choice) {
  const Principled p = principled_of(c, can_transmit);
  const vec3 facet = sample_microfacet(p.facets, wo, u, v);
  const float cosine = max_f(dot3(wo, facet), 0.0f);
  const DielectricFresnel fresnel = dielectric_fresnel(cosine, c.ior);
  const float share_transmitted = p.transmits * (1.0f - fresnel.reflectance);

  const float up_to_coat = p.shares.diffuse + p.shares.clearcoat;
  const bool is_diffuse = choice < p.shares.diffuse;
  const bool is_coat = choice < up_to_coat;
  const bool transmits =
      can_transmit & !is_coat & (choice < up_to_coat + p.shares.specular * share_transmitted);
  const vec3 h = select3(is_coat, gtr1_sample(clearcoat_alpha(c.clearcoat_gloss), u, v), facet);
  const vec3 reflected = mirror_about(wo, h);
  const vec3 refracted = refract_about(wo, facet, cosine, fresnel.cosine, c.ior);
  BsdfSample s = no_bsdf_sample();
  s.wi = select3(is_diffuse, cosine_hemisphere(u, v), select3(transmits, refracted, reflected));
  s.eta = transmits ? c.ior : 1.0f;
  const BsdfValue value = principled_lobes_eval(c, p, can_transmit, wo, s.wi);
  // A facet may scatter to the wrong side of the surface.
  s.pdf = transmits == (s.wi.z < 0.0f) ? value.pdf : 0.0f;
  s.weight = scale(value.f_cos, s.pdf > 0.0f ? 1.0f / s.pdf : 0.0f);
  return s;
}

#define PRINCIPLED_FAMILY(name, can_transmit)                                                   \
  FN BsdfValue name##_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {           \
    return principled_lobes_eval(c, principled_of(c, can_transmit), can_transmit, wo, wi);      \
  }                                                                                             \
  FN BsdfSample name##_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, \
                              float choice) {                                                   \
    return principled_lobes_sample(c, can_transmit, wo, u, v, choice);                          \
  }
PRINCIPLED_FAMILY(principled, false)
PRINCIPLED_FAMILY(principled_transmitting, true)
#undef PRINCIPLED_FAMILY

/// Without sheen and clearcoat.
FN ControlLobes principled_control(const PRIVATE Scene* scene, Closure c, float cosine) {
  const Principled p = principled_of(c, false);
  const MicrofacetLobe lobe = disney_lobe(scene, c, cosine);
  const float at = fresnel_cosine(lobe);
  const DielectricFresnel boundary = dielectric_fresnel(at, c.ior);
  const float weight = schlick_weight_of(c.ior, at, boundary.cosine);
  const vec3 tint = disney_tint(c.diffuse, luminance(c.diffuse));
  const float diffuse = mean_disney_diffuse(cosine, c.roughness, c.flatness);
  return make_control_lobes(scale(c.diffuse, p.brdf * diffuse), lobe,
                            principled_fresnel(c, p, boundary.reflectance, weight, tint));
}

PENUMBRA_NAMESPACE_END
#endif
