// Lambert and a rough dielectric reflection, as in Nori: f = diffuse / pi + specular F D G / (4 cos cos),
// with Beckmann's distribution and roughness alpha_u. The two parts are independent; `specular` is usually
// what the diffuse part leaves.
#ifndef PENUMBRA_MICROFACET_DIFFUSE_H
#define PENUMBRA_MICROFACET_DIFFUSE_H
#include "kernels/bsdf/control_lobes.h"
#include "kernels/bsdf/families.h"
#include "kernels/bsdf/fresnel.h"
#include "kernels/bsdf/microfacet.h"
#include "kernels/bsdf/phong.h"

PENUMBRA_NAMESPACE_BEGIN

FN BsdfValue microfacet_diffuse_eval(const PRIVATE Scene* scene, Closure c, vec3 wo, vec3 wi) {
  const bool reflects = (wi.z > 0.0f) & (wo.z > 0.0f);
  const Microfacets m = make_microfacets(DISTRIBUTION_BECKMANN, c.alpha_u, c.alpha_u);
  const MicrofacetReflection r = microfacet_reflection(m, wo, wi);
  const float fresnel = dielectric_fresnel(r.cosine, c.ior).reflectance;
  const float lambert = wi.z * INV_PI_F, share = phong_lobe_share(c);
  BsdfValue value;
  value.f_cos = add(scale(c.specular, r.f_cos * fresnel), scale(c.diffuse, lambert));
  value.pdf = (1.0f - share) * lambert + share * r.pdf;
  return select_bsdf_value(reflects, value, no_bsdf_value());
}

FN BsdfSample microfacet_diffuse_sample(const PRIVATE Scene* scene, Closure c, vec3 wo, float u, float v,
                                        float choice) {
  const Microfacets m = make_microfacets(DISTRIBUTION_BECKMANN, c.alpha_u, c.alpha_u);
  const vec3 mirrored = mirror_about(wo, sample_microfacet(m, wo, u, v));
  const vec3 wi = select3(choice < phong_lobe_share(c), mirrored, cosine_hemisphere(u, v));
  return sample_of_value(wi, microfacet_diffuse_eval(scene, c, wo, wi));
}

FN ControlLobes microfacet_diffuse_control(const PRIVATE Scene* scene, Closure c, float cosine) {
  const Microfacets m = make_microfacets(DISTRIBUTION_BECKMANN, c.alpha_u, c.alpha_u);
  const MicrofacetLobe lobe = microfacet_lobe(scene, DISTRIBUTION_BECKMANN, m.alpha_u, cosine);
  const float fresnel = dielectric_fresnel(fresnel_cosine(lobe), c.ior).reflectance;
  return make_control_lobes(c.diffuse, lobe, scale(c.specular, fresnel));
}

PENUMBRA_NAMESPACE_END
#endif
