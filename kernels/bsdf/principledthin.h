// The thin principled BSDF of Mitsuba 3, after Burley (2015, section 5.4): a sheet without thickness, the
// same from both sides. `spec_trans` interpolates between two models: diffuse scattering, of which the
// fraction diff_trans / 2 is transmitted, and GGX microfacets that reflect and transmit; transmission is less
// rough and not refracted.
//
// Base colour is `diffuse`; `clearcoat_rate` is the rate of sampling specular transmission.
#ifndef PENUMBRA_PRINCIPLEDTHIN_H
#define PENUMBRA_PRINCIPLEDTHIN_H
#include "kernels/bsdf/disney_lobes.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

/// The parts that do not depend on directions.
typedef struct {
  float diffuse, through;                 // weights of diffuse reflection and diffuse transmission
  float facets_reflect, facets_transmit;  // sampling probabilities; the four sum to 1
  float diffuse_reflects, diffuse_passes;
} ThinSheet;

FN ThinSheet thin_sheet(Closure c) {
  ThinSheet t;
  const float passing = 0.5f * c.diff_trans;
  t.diffuse = (1.0f - c.spec_trans) * (1.0f - passing);
  t.through = (1.0f - c.spec_trans) * passing;
  const float facets_reflect = 0.5f * c.spec_trans * c.specular_rate;
  const float facets_transmit = 0.5f * c.spec_trans * c.clearcoat_rate;
  const float reflects = t.diffuse * c.diffuse_rate, passes = t.through * c.diff_trans_rate;
  const float sum = (facets_reflect + facets_transmit) + (reflects + passes);
  const float scaled = sum > 0.0f ? 1.0f / sum : 0.0f;
  t.facets_reflect = facets_reflect * scaled;
  t.facets_transmit = facets_transmit * scaled;
  t.diffuse_reflects = reflects * scaled;
  t.diffuse_passes = passes * scaled;
  return t;
}

/// Roughness of transmission: the refraction out of the sheet partly undoes that into it (Burley 2015, figure
/// 15).
FN float thin_roughness(Closure c, bool transmits) {
  return transmits ? (0.65f * c.ior - 0.35f) * c.roughness : c.roughness;
}

FN BsdfValue principledthin_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const ThinSheet t = thin_sheet(c);
  const bool reflects = wi.z > 0.0f;
  const vec3 sum = make_vec3(wo.x + wi.x, wo.y + wi.y, wo.z + FABS(wi.z));
  const vec3 h = scale(sum, 1.0f / SQRT(max_f(dot3(sum, sum), 1e-30f)));
  const float cos_o = dot3(wo, h), cos_i = dot3(wi, h), cosine = FABS(wi.z);
  const bool there = (wo.z > 0.0f) & (wi.z != 0.0f);
  // Facets for which wi is on the side to which they scatter.
  const bool facets = there & (cos_o > 0.0f) & (reflects ? cos_i > 0.0f : cos_i < 0.0f);

  const Microfacets m = disney_microfacets(thin_roughness(c, !reflects), c.anisotropic);
  const DielectricFresnel boundary = dielectric_fresnel(FABS(cos_o), c.ior);
  const float fresnel = boundary.reflectance;
  const float weight = schlick_weight_of(c.ior, cos_o, boundary.cosine);
  const float density = facets ? reflected_density(m, wo, h) : 0.0f;
  const float masked = c.spec_trans * density * masking_of_either_side(m, wi);
  const vec3 white = make_vec3(1.0f, 1.0f, 1.0f);
  const vec3 tint = disney_tint(c.diffuse, luminance(c.diffuse));
  const vec3 tinted = mix3(scale(tint, normal_reflectance(c.ior)), white, weight);
  const vec3 reflected = mix3(make_vec3(fresnel, fresnel, fresnel), tinted, c.spec_tint);
  const vec3 specular = scale(select3(reflects, reflected, scale(c.diffuse, 1.0f - fresnel)), masked);

  const float dull = disney_diffuse(wo.z, cosine, cos_i, c.roughness, c.flatness);
  const vec3 sheen = scale(mix3(white, tint, c.sheen_tint), c.sheen * schlick_weight(FABS(cos_i)));
  const vec3 scattered = scale(add_scaled(sheen, INV_PI_F * dull, c.diffuse), t.diffuse);
  const vec3 passed = scale(c.diffuse, INV_PI_F * t.through);

  BsdfValue value;
  value.f_cos = add_scaled(specular, cosine, select3(reflects, scattered, passed));
  value.pdf = (reflects ? t.facets_reflect : t.facets_transmit) * density +
              (reflects ? t.diffuse_reflects : t.diffuse_passes) * INV_PI_F * cosine;
  return select_bsdf_value(there, value, no_bsdf_value());
}

FN BsdfSample principledthin_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                    float choice) {
  const ThinSheet t = thin_sheet(c);
  const float up_to_facets = t.facets_reflect + t.facets_transmit;
  const bool is_facet = choice < up_to_facets;
  const bool transmits = is_facet ? choice >= t.facets_reflect : choice >= up_to_facets + t.diffuse_reflects;
  const vec3 facet =
      sample_microfacet(disney_microfacets(thin_roughness(c, transmits), c.anisotropic), wo, u, v);
  const vec3 above = select3(is_facet, mirror_about(wo, facet), cosine_hemisphere(u, v));
  BsdfSample s = no_bsdf_sample();
  s.wi = make_vec3(above.x, above.y, transmits ? -above.z : above.z);
  const BsdfValue value = principledthin_eval(scene, c, wo, s.wi);
  // A facet may scatter to the wrong side of the surface, or to its own wrong side.
  const float cosine = dot3(s.wi, facet);
  const bool lost = is_facet & ((above.z <= 0.0f) | (transmits ? cosine >= 0.0f : cosine <= 0.0f));
  s.pdf = lost ? 0.0f : value.pdf;
  s.weight = scale(value.f_cos, s.pdf > 0.0f ? 1.0f / s.pdf : 0.0f);
  return s;
}

PENUMBRA_NAMESPACE_END
#endif
