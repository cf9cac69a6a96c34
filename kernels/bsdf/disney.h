// Disney's BRDF (Burley 2012) with the masking of its 2014 revision: that of the anisotropic GGX microfacets
// themselves, as `disney` of Disney's BRDF Explorer has it. The 2012 paper widened them for masking.
//
// Base colour is `diffuse`, subsurface is `flatness`, and specular is `specular_level`: the reflectance along
// the normal is 0.08 times it. Of the diffuse lobe 1 - `spec_trans` is there: the rest is what a part that
// transmits, another BSDF of a blend, takes.
#ifndef PENUMBRA_DISNEY_H
#define PENUMBRA_DISNEY_H
#include "kernels/bsdf/disney_lobes.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

FN bool disney_has_facets(Closure c) { return (c.variant & DISNEY_WITHOUT_MICROFACETS) == 0; }

/// Sheen is sampled by the diffuse lobe, so that one is sampled where only sheen is there.
FN DisneyShares disney_shares_of(Closure c) {
  const float diffuse = max_f(1.0f - c.spec_trans, min_f(c.sheen, 1.0f));
  return disney_shares((1.0f - c.metallic) * diffuse, 0.25f * c.clearcoat,
                       disney_has_facets(c) ? 1.0f : 0.0f);
}

/// The hue of the base colour. Disney's colour weights are not those of Rec. 709.
FN vec3 disney_hue(Closure c) {
  const float own = (0.3f * c.diffuse.x + 0.6f * c.diffuse.y) + 0.1f * c.diffuse.z;
  return disney_tint(c.diffuse, (c.variant & DISNEY_LUMINANCE_TINT) != 0 ? luminance(c.diffuse) : own);
}

FN BsdfValue disney_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const DisneyShares shares = disney_shares_of(c);
  const vec3 sum = add(wo, wi);
  const vec3 h = scale(sum, 1.0f / SQRT(max_f(dot3(sum, sum), 1e-30f)));
  const float cos_h = dot3(wi, h), weight = schlick_weight(cos_h);
  const vec3 white = make_vec3(1.0f, 1.0f, 1.0f);
  const vec3 tint = disney_hue(c);

  const float dielectric = 1.0f - c.metallic;
  const float diffuse =
      disney_diffuse(FABS(wo.z), FABS(wi.z), cos_h, c.roughness, c.flatness) * (1.0f - c.spec_trans);
  const vec3 sheen = scale(mix3(white, tint, c.sheen_tint), c.sheen * weight);
  const vec3 dull = scale(add_scaled(sheen, INV_PI_F * diffuse, c.diffuse), dielectric * wi.z);

  const Microfacets m = disney_microfacets(c.roughness, c.anisotropic);
  const float density = reflected_density(m, wo, h);
  const vec3 plain = scale(mix3(white, tint, c.spec_tint), 0.08f * c.specular_level);
  const vec3 fresnel = mix3(mix3(plain, c.diffuse, c.metallic), white, weight);
  const vec3 shiny = scale(fresnel, disney_has_facets(c) ? density * masking_of_either_side(m, wi) : 0.0f);

  const Clearcoat coat = clearcoat_lobe(c.clearcoat_gloss, weight, wo, wi, h);
  const float coat_cos = c.clearcoat * coat.value * (0.25f / max_f(wo.z, 1e-30f));

  BsdfValue value;
  value.f_cos = add(add(dull, shiny), make_vec3(coat_cos, coat_cos, coat_cos));
  value.pdf = (shares.diffuse * INV_PI_F * wi.z + shares.specular * density) + shares.clearcoat * coat.pdf;
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

FN BsdfSample disney_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, float choice) {
  const DisneyShares shares = disney_shares_of(c);
  const vec3 facet = sample_microfacet(disney_microfacets(c.roughness, c.anisotropic), wo, u, v);
  const vec3 coat = gtr1_sample(clearcoat_alpha(c.clearcoat_gloss), u, v);
  const vec3 reflected = mirror_about(wo, select3(choice < shares.diffuse + shares.clearcoat, coat, facet));
  BsdfSample s = no_bsdf_sample();
  s.wi = select3(choice < shares.diffuse, cosine_hemisphere(u, v), reflected);
  const BsdfValue value = disney_eval(scene, c, wo, s.wi);
  s.pdf = value.pdf;
  s.weight = scale(value.f_cos, s.pdf > 0.0f ? 1.0f / s.pdf : 0.0f);
  return s;
}

/// Without sheen and clearcoat.
FN ControlLobes disney_control(const PRIVATE Scene* scene, Closure c, float cosine) {
  const MicrofacetLobe lobe = disney_lobe(scene, c, cosine);
  const vec3 white = make_vec3(1.0f, 1.0f, 1.0f);
  const vec3 tint = disney_hue(c);
  const vec3 plain = scale(mix3(white, tint, c.spec_tint), 0.08f * c.specular_level);
  const vec3 fresnel = mix3(mix3(plain, c.diffuse, c.metallic), white, schlick_weight(fresnel_cosine(lobe)));
  const float diffuse = mean_disney_diffuse(cosine, c.roughness, c.flatness) * (1.0f - c.spec_trans);
  return make_control_lobes(scale(c.diffuse, (1.0f - c.metallic) * diffuse), lobe,
                            scale(fresnel, disney_has_facets(c) ? 1.0f : 0.0f));
}

PENUMBRA_NAMESPACE_END
#endif
