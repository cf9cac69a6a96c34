// Conductors: smooth ones, mirrors with Fresnel's reflectance, and rough ones.
#ifndef PENUMBRA_CONDUCTOR_H
#define PENUMBRA_CONDUCTOR_H
#include "kernels/bsdf/control_lobes.h"
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/bsdf/microfacet.h"
#include "kernels/scene.h"

PENUMBRA_NAMESPACE_BEGIN

FN BsdfValue conductor_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  return no_bsdf_value();
}

FN BsdfSample conductor_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                               float choice) {
  BsdfSample s = no_bsdf_sample();
  s.wi = make_vec3(-wo.x, -wo.y, wo.z);
  s.weight = mul(c.specular, conductor_fresnel(wo.z, c.eta, c.k));
  s.pdf = wo.z > 0.0f ? DELTA_PDF : 0.0f;
  return s;
}

// Rough conductors: microfacets with Fresnel's reflectance, one family for each distribution.

FN BsdfValue conductor_lobe_eval(Microfacets m, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  const MicrofacetReflection r = microfacet_reflection(m, wo, wi);
  BsdfValue value;
  value.f_cos = scale(mul(c.specular, conductor_fresnel(r.cosine, c.eta, c.k)), r.f_cos);
  value.pdf = r.pdf;
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

FN BsdfSample conductor_lobe_sample(Microfacets m, Closure c, vec3 wo, float u, float v) {
  const vec3 h = sample_microfacet(m, wo, u, v);
  const float cosine = dot3(wo, h);
  BsdfSample s = no_bsdf_sample();
  s.wi = mirror_about(wo, h);
  const bool reflects = (s.wi.z > 0.0f) & (wo.z > 0.0f) & (cosine > 0.0f);
  const vec3 fresnel = mul(c.specular, conductor_fresnel(cosine, c.eta, c.k));
  const float pdf = 0.25f * (microfacet_density(m, h) * microfacet_visible_over_cosine(m, wo));
  s.weight = scale(fresnel, reflects ? microfacet_weight(m, wo, s.wi) : 0.0f);
  s.pdf = reflects ? pdf : 0.0f;
  return s;
}

#define ROUGH_CONDUCTOR(name, NAME)                                                             \
  FN BsdfValue name##_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {           \
    const Microfacets m = make_microfacets(DISTRIBUTION_##NAME, c.alpha_u, c.alpha_v);          \
    return conductor_lobe_eval(m, c, wo, wi);                                                   \
  }                                                                                             \
  FN BsdfSample name##_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v, \
                              float choice) {                                                   \
    const Microfacets m = make_microfacets(DISTRIBUTION_##NAME, c.alpha_u, c.alpha_v);          \
    return conductor_lobe_sample(m, c, wo, u, v);                                               \
  }
ROUGH_CONDUCTOR(roughconductor_ggx, GGX)
ROUGH_CONDUCTOR(roughconductor_beckmann, BECKMANN)
#undef ROUGH_CONDUCTOR

/// An anisotropic lobe is replaced by an isotropic one of the same area.
#define ROUGH_CONDUCTOR_CONTROL(name, NAME)                                                 \
  FN ControlLobes name##_control(const PRIVATE Scene* scene, Closure c, float cosine) {     \
    const Microfacets m = make_microfacets(DISTRIBUTION_##NAME, c.alpha_u, c.alpha_v);      \
    const MicrofacetLobe lobe =                                                             \
        microfacet_lobe(scene, DISTRIBUTION_##NAME, SQRT(m.alpha_u * m.alpha_v), cosine);   \
    const vec3 fresnel = conductor_fresnel(fresnel_cosine(lobe), c.eta, c.k);               \
    return make_control_lobes(make_vec3(0.0f, 0.0f, 0.0f), lobe, mul(c.specular, fresnel)); \
  }
ROUGH_CONDUCTOR_CONTROL(roughconductor_ggx, GGX)
ROUGH_CONDUCTOR_CONTROL(roughconductor_beckmann, BECKMANN)
#undef ROUGH_CONDUCTOR_CONTROL

PENUMBRA_NAMESPACE_END
#endif
